#include "localiser_particles.hpp"

namespace slalom::vehicle::detail {
namespace {

/// The binary digits of i after the point, an evenly spread sequence in [0, 1) (van der Corput 1935).
double radical_inverse(std::uint32_t i) {
  i = (i << 16) | (i >> 16);
  i = ((i & 0x00ff00ffu) << 8) | ((i >> 8) & 0x00ff00ffu);
  i = ((i & 0x0f0f0f0fu) << 4) | ((i >> 4) & 0x0f0f0f0fu);
  i = ((i & 0x33333333u) << 2) | ((i >> 2) & 0x33333333u);
  i = ((i & 0x55555555u) << 1) | ((i >> 1) & 0x55555555u);
  return i * 0x1p-32;
}

}  // namespace

Particles::Particles(const LocaliserOptions& options, std::shared_ptr<const FreeCells> free_cells)
    : options_(options),
      free_cells_(std::move(free_cells)),
      now_(1, 3, options.max_particles),
      next_(1, 3, options.max_particles),
      noise_(1, 3, options.max_particles),
      log_fit_(padded(options.max_particles)),
      weights_(options.max_particles),
      cumulative_(weights_.size()),
      guide_(weights_.size()),
      bins_(options.max_particles, bin_size, bin_angle),
      places_(options.max_particles, place_size, place_angle) {}

void Particles::spread_about(const maps::Pose& pose, double deviation, double yaw_deviation,
                             RandomKey key) noexcept {
  fill_normal(noise_, 0, noise_.stride(), key);
  for (int i = 0; i < options_.max_particles; ++i)
    put_pose(now_, i,
             {pose.x + deviation * noise_.at(0, 0, i), pose.y + deviation * noise_.at(0, 1, i),
              maps::wrap_angle(pose.yaw + yaw_deviation * noise_.at(0, 2, i))});
  make_uniform(options_.max_particles);
}

void Particles::spread_everywhere(RandomKey key) noexcept {
  RandomStream random(key);
  for (int i = 0; i < options_.max_particles; ++i) put_pose(now_, i, free_cells_->random_pose(random));
  make_uniform(options_.max_particles);
}

void Particles::move(const Displacement& moved, RandomKey key) noexcept {
  fill_normal(noise_, 0, padded(count_), key);
  const float along = static_cast<float>(moved.step.x), across = static_cast<float>(moved.step.y);
  const float turn = static_cast<float>(moved.step.yaw);
  const float along_deviation = static_cast<float>(moved.along);
  const float across_deviation = static_cast<float>(moved.across);
  const float turn_deviation = static_cast<float>(moved.turn);
  float *x = now_.row(0, 0), *y = now_.row(0, 1), *yaw = now_.row(0, 2);
  const float *a = noise_.row(0, 0), *b = noise_.row(0, 1), *c = noise_.row(0, 2);
  for (int i = 0; i < count_; ++i) {
    const float dx = along + along_deviation * a[i], dy = across + across_deviation * b[i];
    const float cosine = std::cos(yaw[i]), sine = std::sin(yaw[i]);
    x[i] += cosine * dx - sine * dy;
    y[i] += sine * dx + cosine * dy;
    yaw[i] = slalom::wrap_angle(yaw[i] + turn + turn_deviation * c[i]);
  }
}

double Particles::weigh(const SensorTables& sensor, const ScanBeams& beams, double exponent) noexcept {
  float* log_fit = log_fit_.data();
  sensor.weigh(poses_of(now_, padded(count_)), beams, log_fit);
  const float best = *std::max_element(log_fit, log_fit + count_);
  const int used = sensor.model() == SensorModel::beam ? beams.count : beams.hits;
  const float power = static_cast<float>(exponent * used);
  double sum = 0;
  for (int i = 0; i < count_; ++i) {
    double& weight = weights_[i];
    weight *= static_cast<double>(std::exp(power * (log_fit[i] - best)));
    sum += weight;
  }
  // The best particle's own weight may have been tiny before.
  if (!(sum > 1e-290)) {
    make_uniform(count_);
    return count_;
  }
  double squares = 0;
  for (int i = 0; i < count_; ++i) {
    double& weight = weights_[i];
    weight /= sum;
    squares += weight * weight;
  }
  return 1 / squares;
}

void Particles::resample(RandomKey key) noexcept {
  accumulate_weights();
  const double shift = RandomStream(key).uniform();
  bins_.clear();
  int drawn = 0;
  double wanted = options_.min_particles;
  while (drawn < wanted && drawn < options_.max_particles) {
    double uniform = radical_inverse(static_cast<std::uint32_t>(drawn)) + shift;
    uniform -= uniform >= 1;
    const maps::Pose chosen = pose(draw(uniform));
    put_pose(next_, drawn++, chosen);
    if (bins_.add(chosen.x, chosen.y, chosen.yaw, 1))
      wanted = std::max<double>(options_.min_particles,
                                kld_sample_size(bins_.occupied(), kld_error, kld_quantile));
  }
  std::swap(now_, next_);
  make_uniform(drawn);
}

Particles::Estimate Particles::estimate() noexcept {
  places_.clear();
  for (int i = 0; i < count_; ++i) places_.add(x(i), y(i), yaw(i), weight(i));
  maps::Pose middle;
  for (int i = 0; i < count_; ++i) {
    if (!places_.in_heaviest(x(i), y(i), yaw(i))) continue;
    middle = pose(i);
    break;
  }
  Estimate found;
  // The window about any particle of the bin is moved onto the mean of what lies in it, twice.
  for (int pass = 0; pass < 3; ++pass) {
    double sum = 0, m[3] = {}, second[3][3] = {};
    for (int i = 0; i < count_; ++i) {
      const double d[3] = {x(i) - middle.x, y(i) - middle.y, maps::wrap_angle(yaw(i) - middle.yaw)};
      if (d[0] * d[0] + d[1] * d[1] > near_distance * near_distance || std::abs(d[2]) > near_angle) continue;
      const double w = weight(i);
      sum += w;
      for (int a = 0; a < 3; ++a) {
        m[a] += w * d[a];
        for (int b = 0; b < 3; ++b) second[a][b] += w * d[a] * d[b];
      }
    }
    if (!(sum > 0)) break;
    for (double& mean : m) mean /= sum;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) found.covariance[a][b] = second[a][b] / sum - m[a] * m[b];
    middle = {middle.x + m[0], middle.y + m[1], maps::wrap_angle(middle.yaw + m[2])};
    found.share = std::min(1.0, sum);
  }
  found.pose = middle;
  return found;
}

void Particles::make_uniform(int count) noexcept {
  count_ = count;
  std::fill_n(weights_.begin(), count, 1.0 / count);
}

void Particles::accumulate_weights() noexcept {
  double sum = 0;
  int part = 0;
  for (int i = 0; i < count_; ++i) {
    sum += weights_[i];
    cumulative_[i] = sum;
    for (; part < count_ && part < sum * count_; ++part) guide_[part] = i;
  }
  for (; part < count_; ++part) guide_[part] = count_ - 1;
}

int Particles::draw(double uniform) const noexcept {
  int i = guide_[saturate_cast<std::size_t>(uniform * count_)];
  while (i + 1 < count_ && cumulative_[i] <= uniform) ++i;
  return i;
}

}  // namespace slalom::vehicle::detail
