// A method of one's own: predictive sampling (Howell et al., "Predictive Sampling", 2022). Of many disturbed
// copies of the last plan the best is the next plan. It solves whatever the other methods solve.

#include <algorithm>
#include <cmath>
#include <vector>

#include <slalom/core/random.hpp>
#include <slalom/slalom.hpp>

#include "seeds.hpp"

/// The method: draw, evaluate, take the best.
class PredictiveSampling final : public slalom::Solver {
 public:
  PredictiveSampling(int horizon, int inputs, int samples, float deviation, std::uint64_t seed)
      : batch_(horizon, inputs, samples),
        costs_(static_cast<std::size_t>(batch_.stride())),
        collided_(costs_.size()),
        plan_(static_cast<std::size_t>(horizon * inputs)),
        deviation_(deviation) {
    reset(seed);
  }
  const char* name() const noexcept override { return "predictive_sampling"; }
  int horizon() const noexcept override { return batch_.steps(); }
  int inputs() const noexcept override { return batch_.inputs(); }
  void reset(std::uint64_t seed) noexcept override {
    key_ = {seed, 0};
    std::fill(plan_.begin(), plan_.end(), 0.0f);
  }

  const slalom::SolveResult& solve(const slalom::BatchEvaluator& evaluator,
                                   const slalom::SolveRequest&) noexcept override {
    const int rows = horizon() * inputs();
    std::rotate(plan_.begin(), plan_.begin() + inputs(), plan_.end());  // one step has passed
    slalom::fill_normal(batch_, 0, batch_.stride(), key_);
    ++key_.stream;
    for (int r = 0; r < rows; ++r) {
      float* row = batch_.row(0, 0) + r * batch_.stride();
      const float last = plan_[static_cast<std::size_t>(r)];
      for (int k = 0; k < batch_.samples(); ++k) row[k] = k == 0 ? last : last + deviation_ * row[k];
    }
    evaluator.evaluate(batch_, 0, batch_.samples(), costs_.data(), collided_.data());
    const auto best = std::min_element(costs_.begin(), costs_.begin() + batch_.samples()) - costs_.begin();
    for (int r = 0; r < rows; ++r)
      plan_[static_cast<std::size_t>(r)] = batch_.row(0, 0)[r * batch_.stride() + best];
    result_.inputs = plan_;
    result_.minimum_cost = static_cast<double>(costs_[static_cast<std::size_t>(best)]);
    return result_;
  }

 private:
  slalom::SequenceBatch batch_;
  std::vector<float> costs_;
  std::vector<std::uint8_t> collided_;
  std::vector<float> plan_;  // [step][input]
  float deviation_;
  slalom::RandomKey key_;
  slalom::SolveResult result_;
};

struct Point {  // pushed about in the plane
  template <class T>
  struct State {
    T x, y, speed_x, speed_y;  // m, m/s
  };
  static constexpr int inputs = 2;  // m/s^2
  double dt = 0.1;                  // s

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    return {x.x + T(dt) * x.speed_x, x.y + T(dt) * x.speed_y, x.speed_x + T(dt) * u[0],
            x.speed_y + T(dt) * u[1]};
  }
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 2>& u) const {
    return x.x * x.x + x.y * x.y + T(0.01) * (u[0] * u[0] + u[1] * u[1]);
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * (x.x * x.x + x.y * x.y + x.speed_x * x.speed_x + x.speed_y * x.speed_y);
  }
};

int main() {
  const int count = succeeded([](auto seed) {
    slalom::Controller controller{Point{}, std::make_unique<PredictiveSampling>(20, 2, 512, 0.5f, seed)};
    Point::State<double> x{2, -1, 0, 0};
    for (int k = 0; k < 100; ++k) x = Point{}.step(x, controller.solve(x).inputs[0]);
    return std::hypot(x.x, x.y) < 0.15;
  });
  std::printf("the point comes to rest: predictive_sampling %d of 20 seeds\n", count);
  return count == 20 ? 0 : 1;
}
