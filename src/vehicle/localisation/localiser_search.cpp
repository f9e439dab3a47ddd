#include "localiser_search.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr double same_place = 0.35, same_yaw = 0.3;  // m, rad

bool is_same_place(const maps::Pose& a, const maps::Pose& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy < same_place * same_place && std::abs(maps::wrap_angle(a.yaw - b.yaw)) < same_yaw;
}

}  // namespace

Search::Search(std::shared_ptr<const FreeCells> free_cells)
    : free_cells_(std::move(free_cells)),
      poses_(1, 3, max_hypotheses * (copies + search_factor)),
      noise_(1, 3, max_hypotheses * copies),
      log_fit_(poses_.stride()),
      hypotheses_(max_hypotheses),
      newcomers_(newcomers) {}

void Search::update(const maps::Pose& step, const SensorTables& sensor, const ScanBeams& beams, double memory,
                    RandomKey key) noexcept {
  for (int h = 0; h < count_; ++h) {
    maps::Pose& pose = hypotheses_[h].pose;
    const maps::Point moved = maps::transform(pose, {step.x, step.y});
    pose = {moved.x, moved.y, maps::wrap_angle(pose.yaw + step.yaw)};
  }
  place_copies(key);
  place_random(key);
  sensor.weigh_by_field(poses_of(poses_, poses_.stride()), beams, log_fit_.data());
  const int first_random = count_ * copies;
  take_best_copies(memory);
  drop_twins();
  admit(first_random);
}

const Search::Hypothesis* Search::best() const noexcept {
  const Hypothesis* found = nullptr;
  for (int h = 0; h < count_; ++h) {
    const Hypothesis& other = hypotheses_[h];
    if (other.age > young && (!found || other.log_fit > found->log_fit)) found = &other;
  }
  return found;
}

double Search::log_fit_at(const maps::Pose& pose, const SensorTables& sensor,
                          const ScanBeams& beams) noexcept {
  for (int i = 0; i < simd::padding; ++i) put(i, pose);
  sensor.weigh_by_field(poses_of(poses_, simd::padding), beams, log_fit_.data());
  return static_cast<double>(log_fit_[0]);
}

bool Search::confirms(const maps::Pose& other, const maps::Pose& place, const SensorTables& sensor,
                      const ScanBeams& beams) noexcept {
  for (int i = 0; i < simd::padding; ++i) put(i, i == 0 ? other : place);
  sensor.weigh(poses_of(poses_, simd::padding), beams, log_fit_.data());
  return log_fit_[0] > log_fit_[1];
}

void Search::place_copies(RandomKey key) noexcept {
  fill_normal(noise_, 0, padded(count_ * copies), key);
  for (int h = 0, i = 0; h < count_; ++h) {
    const Hypothesis& from = hypotheses_[h];
    const double jitter = from.age < young ? young_jitter : grown_jitter;
    const double yaw_jitter = from.age < young ? young_yaw_jitter : grown_yaw_jitter;
    put(i++, from.pose);
    for (int k = 1; k < copies; ++k, ++i)
      put(i, {from.pose.x + jitter * noise_.at(0, 0, i), from.pose.y + jitter * noise_.at(0, 1, i),
              maps::wrap_angle(from.pose.yaw + yaw_jitter * noise_.at(0, 2, i))});
  }
}

void Search::place_random(RandomKey key) noexcept {
  RandomStream random(key);
  for (int i = count_ * copies; i < poses_.samples(); ++i) put(i, free_cells_->random_pose(random));
}

void Search::take_best_copies(double memory) noexcept {
  for (int h = 0; h < count_; ++h) {
    const float* fits = log_fit_.data() + h * copies;
    const int best = static_cast<int>(std::max_element(fits, fits + copies) - fits);
    Hypothesis& to = hypotheses_[h];
    to.pose = batch_pose(h * copies + best);
    const double fit = static_cast<double>(fits[best]);
    to.log_fit = to.age <= young ? fit : memory * to.log_fit + (1 - memory) * fit;
    ++to.age;
  }
}

void Search::drop_twins() noexcept {
  for (int a = 0; a < count_; ++a) {
    Hypothesis& first = hypotheses_[a];
    for (int b = count_ - 1; b > a; --b) {
      Hypothesis& second = hypotheses_[b];
      if (!is_same_place(first.pose, second.pose)) continue;
      const int age = std::max(first.age, second.age);
      if (second.log_fit > first.log_fit) first = second;
      first.age = age;
      second = hypotheses_[--count_];
    }
  }
}

void Search::admit(int first) noexcept {
  int chosen = 0;
  for (int i = first; i < poses_.samples(); ++i) {
    const float fit = log_fit_[i];
    const auto worse = [&](int other) { return log_fit_[other] < fit; };
    if (chosen == newcomers && !worse(newcomers_[newcomers - 1])) continue;
    if (chosen < newcomers) ++chosen;
    int at = chosen - 1;
    for (; at > 0 && worse(newcomers_[at - 1]); --at) newcomers_[at] = newcomers_[at - 1];
    newcomers_[at] = i;
  }
  for (int n = 0; n < chosen; ++n) {
    const int from = newcomers_[n];
    int to = count_;
    if (count_ < max_hypotheses) {
      ++count_;
    } else {
      to = -1;
      for (int h = 0; h < count_; ++h) {
        const Hypothesis& old = hypotheses_[h];
        if (old.age > young && (to < 0 || old.log_fit < hypotheses_[to].log_fit)) to = h;
      }
      if (to < 0) return;
    }
    hypotheses_[to] = {batch_pose(from), static_cast<double>(log_fit_[from]), 1};
  }
}

}  // namespace slalom::vehicle::detail
