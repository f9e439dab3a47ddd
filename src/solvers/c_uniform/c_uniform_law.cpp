#include "slalom/solvers/c_uniform/c_uniform_law.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "slalom/core/option_access.hpp"
#include "solvers/all_finite.hpp"
#include "solvers/c_uniform/level_flow.hpp"

namespace slalom {
namespace {

using detail::all_finite;

/// Most combinations of input values, and steps.
constexpr int most_choices = 256, longest_horizon = 10000;

/// Relative duality gap at which the masses of a level are even enough.
constexpr double even_enough = 1e-4;

/// Cells along an axis in either direction; what lies beyond counts as not finite.
constexpr double most_along_axis = 1e9;

void require_c_uniform(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("c_uniform: " + what);
}

/// All combinations [choice][input] of the values of each input.
std::vector<double> combinations(const InputBounds& bounds, const PerInput& counts) {
  const std::size_t inputs = bounds.low.size();
  std::vector<double> all(inputs);
  for (std::size_t i = 0; i < inputs; ++i) {
    const std::string input = "input " + std::to_string(i);
    const double low = bounds.low[i], high = bounds.high[i], count = counts[static_cast<int>(i)];
    require_c_uniform(std::isfinite(low) && std::isfinite(high) && low <= high,
                      input + " has the bounds " + to_text(low) + " and " + to_text(high) +
                          ", must have finite ones, the lower first");
    require_c_uniform(count == std::round(count),
                      "input_values " + to_text(count) + " must be a whole number");
    std::vector<double> more;
    for (std::size_t from = 0; from < all.size(); from += inputs) {
      for (double v = 0; v < count; ++v) {
        more.insert(more.end(), all.begin() + static_cast<std::ptrdiff_t>(from),
                    all.begin() + static_cast<std::ptrdiff_t>(from + inputs));
        const double part = count > 1 ? v / (count - 1) : 0.5;
        more[more.size() - inputs + i] = std::clamp((1 - part) * low + part * high, low, high);
      }
    }
    all = std::move(more);
    require_c_uniform(
        all.size() <= most_choices * inputs,
        "input_values make more than " + std::to_string(most_choices) + " combinations, must make fewer");
  }
  return all;
}

}  // namespace

/// Builds the levels one after the other.
class CUniformLaw::Builder {
 public:
  Builder(CUniformLaw& law, CellDynamics& system, std::span<const double> start,
          std::span<const CellAxis> axes, const CUniformOptions& options)
      : law_(law),
        system_(system),
        options_(options),
        axes_(axes.begin(), axes.end()),
        origin_(axes.size()),
        location_(axes.size()),
        states_(start.begin(), start.end()),
        now_(start.size()),
        next_(start.size()) {
    require_c_uniform(!axes_.empty(), "there must be an axis");
    for (CellAxis& axis : axes_) {
      require_c_uniform(axis.size > 0 && std::isfinite(axis.size),
                        "the size " + to_text(axis.size) + " of a cell must be above 0 and finite");
      require_c_uniform(axis.period == 0 || (axis.period >= axis.size && std::isfinite(axis.period)),
                        "the period " + to_text(axis.period) +
                            " of an axis must be 0, or finite and at least " + to_text(axis.size) +
                            ", the size of a cell");
      if (axis.period > 0) axis.size = axis.period / std::round(axis.period / axis.size);
    }
    require_c_uniform(!start.empty() && all_finite(start), "the start must be finite");
    system_.locate(start, origin_);
    require_c_uniform(all_finite(origin_), "the coordinates of the start must be finite");
    law_.levels_.push_back({{1.0}, {}, {}});
  }

  /// Adds the next level.
  void add_level() {
    arrive();
    find_cells();
    distribute();
  }

 private:
  std::size_t axis_count() const { return axes_.size(); }
  std::size_t choice_count() const { return at(law_.choices_); }
  std::span<const double> state(std::size_t cell) const {
    return std::span(states_).subspan(cell * now_.size(), now_.size());
  }

  /// Moves from the state of a cell with a choice, to `now_`.
  void move(std::size_t cell, int choice) {
    const int level = law_.levels();
    const int first = level * law_.input_steps_, end = std::min(first + law_.input_steps_, law_.horizon_);
    std::copy_n(state(cell).begin(), now_.size(), now_.begin());
    for (int k = first; k < end; ++k) {
      system_.step(k, now_, law_.choice(choice), next_);
      now_.swap(next_);
    }
  }

  /// Writes the cell of `now_` to `key` [axis]. Returns its squared distance from the centre, in cells, or a
  /// negative number if it is not finite.
  double find_key(int* key) {
    if (!all_finite(now_)) return -1;
    system_.locate(now_, location_);
    double offset = 0;
    for (std::size_t a = 0; a < axis_count(); ++a) {
      const CellAxis& axis = axes_[a];
      double way = location_[a] - origin_[a];
      if (axis.period > 0) way = std::remainder(way, axis.period);
      const double cells = way / axis.size, centre = std::round(cells);
      if (!(std::abs(cells) < most_along_axis)) return -1;
      offset += (cells - centre) * (cells - centre);
      key[a] = static_cast<int>(centre);
      // Both ends of a period are in one cell.
      if (axis.period > 0 && 2 * centre <= -std::round(axis.period / axis.size))
        key[a] += static_cast<int>(std::round(axis.period / axis.size));
    }
    return offset;
  }

  /// Finds where each choice leads from each cell of the last level.
  void arrive() {
    const std::size_t arrivals = law_.levels_.back().masses.size() * choice_count();
    keys_.resize(arrivals * axis_count());
    offsets_.resize(arrivals);
    order_.clear();
    for (std::size_t i = 0; i < arrivals; ++i) {
      const std::size_t cell = i / choice_count();
      move(cell, static_cast<int>(i % choice_count()));
      offsets_[i] = find_key(keys_.data() + i * axis_count());
      if (offsets_[i] >= 0) order_.push_back(i);
      require_c_uniform(
          (i + 1) % choice_count() != 0 || (!order_.empty() && order_.back() / choice_count() == cell),
          "no input leads from a cell of level " + std::to_string(law_.levels()) + " to a finite state");
    }
  }

  /// Numbers the cells that are reached. The state of a cell is the one nearest to its centre.
  void find_cells() {
    const auto key = [&](std::size_t arrival) {
      return std::span<const int>(keys_).subspan(arrival * axis_count(), axis_count());
    };
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      const auto of_a = key(a), of_b = key(b);
      const auto [in_a, in_b] = std::mismatch(of_a.begin(), of_a.end(), of_b.begin());
      if (in_a != of_a.end()) return *in_a < *in_b;
      return offsets_[a] < offsets_[b] || (offsets_[a] == offsets_[b] && a < b);
    });
    std::vector<int>& next = law_.levels_.back().next;
    next.assign(offsets_.size(), -1);
    std::vector<double> states;
    int cells = 0;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      if (i == 0 || !std::ranges::equal(key(order_[i]), key(order_[i - 1]))) {
        ++cells;
        move(order_[i] / choice_count(), static_cast<int>(order_[i] % choice_count()));
        states.insert(states.end(), now_.begin(), now_.end());
      }
      next[order_[i]] = cells - 1;
    }
    states_ = std::move(states);
    all_cells_ += cells;
    reached_ = cells;
    require_c_uniform(all_cells_ <= options_.cells,
                      "there are more than " + std::to_string(options_.cells) + " cells up to level " +
                          std::to_string(law_.levels() + 1) + " of " +
                          std::to_string((law_.horizon_ + law_.input_steps_ - 1) / law_.input_steps_) +
                          ", must be fewer: with larger cells, fewer input values, a longer input_steps or a "
                          "shorter horizon");
  }

  /// Finds the probabilities of the last level, and adds the one that they lead to.
  void distribute() {
    Level& level = law_.levels_.back();
    detail::LevelFlow flow;
    flow.supply = level.masses;
    flow.mass.resize(at(reached_));
    flow.first.push_back(0);
    for (std::size_t cell = 0; cell < flow.supply.size(); ++cell) {
      sort_targets(cell);
      for (std::size_t i = 0; i < targets_.size(); ++i)
        if (i == 0 || targets_[i].first != targets_[i - 1].first) flow.target.push_back(targets_[i].first);
      flow.first.push_back(static_cast<int>(flow.target.size()));
    }
    flow.start();
    flow.level_out(options_.sweeps, even_enough);
    level.probabilities.assign(level.next.size(), 0.0f);
    for (std::size_t cell = 0; cell < flow.supply.size(); ++cell) share(flow, cell);
    law_.levels_.push_back({std::move(flow.mass), {}, {}});
  }

  /// Sorts the choices of a cell that lead to a finite state by their target.
  void sort_targets(std::size_t cell) {
    targets_.clear();
    const std::vector<int>& next = law_.levels_.back().next;
    for (int c = 0; c < law_.choices_; ++c) {
      const int target = next[law_.place(static_cast<int>(cell), c)];
      if (target >= 0) targets_.emplace_back(target, c);
    }
    std::sort(targets_.begin(), targets_.end());
  }

  /// Choices that lead to the same cell share its probability evenly. A mass may be so small that it is 0.
  void share(const detail::LevelFlow& flow, std::size_t cell) {
    sort_targets(cell);
    auto from = targets_.begin();
    for (int e = flow.first[cell]; e < flow.first[cell + 1]; ++e) {
      const auto end =
          std::find_if(from, targets_.end(), [&](auto& t) { return t.first != flow.target[at(e)]; });
      const double part = flow.supply[cell] > 0 ? flow.flow[at(e)] / flow.supply[cell]
                                                : 1.0 / (flow.first[cell + 1] - flow.first[cell]);
      for (const auto count = static_cast<double>(end - from); from != end; ++from)
        law_.levels_.back().probabilities[law_.place(static_cast<int>(cell), from->second)] =
            static_cast<float>(part / count);
    }
  }

  CUniformLaw& law_;
  CellDynamics& system_;
  const CUniformOptions& options_;
  std::vector<CellAxis> axes_;
  std::vector<double> origin_, location_;     ///< coordinates of the start and of a state, [axis]
  std::vector<double> states_;                ///< of the cells of the last level, [cell][state]
  std::vector<double> now_, next_;            ///< a state
  std::vector<int> keys_;                     ///< [cell][choice][axis]
  std::vector<double> offsets_;               ///< [cell][choice]
  std::vector<std::size_t> order_;            ///< arrivals [cell][choice], by key
  std::vector<std::pair<int, int>> targets_;  ///< of a cell, with the choice that leads there
  int reached_ = 0;                           ///< cells of the next level
  long all_cells_ = 1;
};

CUniformLaw::CUniformLaw(CellDynamics& system, std::span<const double> start, std::span<const CellAxis> axes,
                         int horizon, const InputBounds& bounds, const CUniformOptions& options)
    : horizon_(horizon), inputs_(static_cast<int>(bounds.low.size())), input_steps_(options.input_steps) {
  require_c_uniform(
      horizon >= 1 && horizon <= longest_horizon,
      "the horizon " + std::to_string(horizon) + " must be in [1, " + std::to_string(longest_horizon) + "]");
  require_c_uniform(inputs_ >= 1 && bounds.high.size() == bounds.low.size(),
                    "there must be two bounds for each input");
  validate_options(options, "c_uniform", inputs_);
  values_ = combinations(bounds, options.input_values);
  choices_ = static_cast<int>(values_.size() / bounds.low.size());
  Builder builder(*this, system, start, axes, options);
  while (levels() * input_steps_ < horizon_) builder.add_level();
}

std::span<const double> CUniformLaw::choice(int index) const noexcept {
  return std::span(values_).subspan(at(index) * at(inputs_), at(inputs_));
}

std::span<const float> CUniformLaw::probabilities(int level, int cell) const noexcept {
  return std::span(levels_[at(level)].probabilities).subspan(place(cell, 0), at(choices_));
}

int CUniformLaw::next_cell(int level, int cell, int choice) const noexcept {
  return levels_[at(level)].next[place(cell, choice)];
}

void CUniformLaw::draw(RandomStream& random, std::span<double> sequence) const noexcept {
  int cell = 0;
  for (int level = 0; level < levels(); ++level) {
    const std::span<const float> chances = probabilities(level, cell);
    double left = random.uniform();
    int chosen = 0;
    for (int c = 0; c < choices_ && left >= 0; ++c) {
      if (chances[at(c)] <= 0) continue;  // the probabilities sum to 1 up to rounding
      chosen = c;
      left -= static_cast<double>(chances[at(c)]);
    }
    const int first = level * input_steps_, end = std::min(first + input_steps_, horizon_);
    for (int k = first; k < end; ++k)
      std::copy_n(choice(chosen).begin(), inputs_,
                  sequence.begin() + static_cast<std::ptrdiff_t>(k) * inputs_);
    cell = next_cell(level, cell, chosen);
  }
}

}  // namespace slalom
