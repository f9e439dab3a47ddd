#include "slalom/solvers/feedback_gains.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/option_access.hpp"

namespace slalom {
namespace {

bool all_finite(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::size_t count(int a, int b = 1, int c = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c);
}

std::span<double> part(std::vector<double>& all, int index, std::size_t size) {
  return std::span(all).subspan(static_cast<std::size_t>(index) * size, size);
}

/// Added to the diagonal of a matrix that may be singular, relative to its largest entry there.
constexpr double ridge = 1e-10;

// Views of vectors, and a factor in place: nothing allocates. Nor do lazy products.
using Map = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
using Vector = Eigen::Map<Eigen::VectorXd>;
using Cholesky = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>;

/// Replaces a symmetric matrix by the nearest positive semidefinite one: negative eigenvalues become 0.
/// `work` is of the same size.
void make_semidefinite(Map a, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& eigen, Eigen::MatrixXd& work) {
  const double largest = a.diagonal().cwiseAbs().maxCoeff();
  work = 0.5 * (a + a.transpose());
  work.diagonal().array() += ridge * largest;
  if (Cholesky(work).info() == Eigen::Success) return;
  work = 0.5 * (a + a.transpose());
  eigen.compute(work);
  a = (eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal())
          .lazyProduct(eigen.eigenvectors().transpose());
}

}  // namespace

/// Matrices of the recursion, in double; n states, m inputs.
struct FeedbackGains::Workspace {
  Workspace(int n, int m)
      : value(n, n),
        hessian(n + m, n + m),
        product(n, n + m),
        of_states(n, n),
        of_all(n + m, n + m),
        inputs_gain(m, n),
        quu(m, m),
        qux(m, n),
        value_gradient(n),
        gradient(n + m),
        eigen_of_states(n),
        eigen_of_all(n + m) {}
  std::unique_ptr<Workspace> clone() const { return std::make_unique<Workspace>(*this); }

  Eigen::MatrixXd value;                       ///< Hessian of the cost to go, by the state
  Eigen::MatrixXd hessian;                     ///< Hessian of the cost to go, by state and inputs
  Eigen::MatrixXd product, of_states, of_all;  ///< working memory
  Eigen::MatrixXd inputs_gain;                 ///< Quu K
  Eigen::MatrixXd quu, qux;                    ///< for the free inputs
  Eigen::VectorXd value_gradient;              ///< gradient of the cost to go, by the state
  Eigen::VectorXd gradient;                    ///< gradient of the cost to go, by state and inputs
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_of_states, eigen_of_all;
};

FeedbackGains::FeedbackGains(int states, int inputs, int steps, const InputBounds& bounds)
    : states_(states), inputs_(inputs), steps_(steps), bounds_(bounds) {
  const auto require = [](int value, const char* what) {
    if (value < 1)
      throw std::invalid_argument(std::string("feedback: ") + what + ": " + std::to_string(value) +
                                  " must be at least 1");
  };
  require(states, "number of states");
  require(inputs, "number of inputs");
  require(steps, "number of steps");
  if (bounds.low.size() != count(inputs) || bounds.high.size() != count(inputs))
    throw std::invalid_argument("feedback: bounds: must be given for each of " + std::to_string(inputs) +
                                " inputs");
  for (std::size_t i = 0; i < count(inputs); ++i)
    if (!(bounds.low[i] <= bounds.high[i]))
      throw std::invalid_argument("feedback: bounds: the lower bound of input " + std::to_string(i) + ", " +
                                  to_text(bounds.low[i]) + ", must be at most the upper bound, " +
                                  to_text(bounds.high[i]));
  const int all = states + inputs;
  plan_states_.resize(count(steps + 1, states));
  plan_inputs_.resize(count(steps, inputs));
  for (std::size_t i = 0; i < plan_inputs_.size(); ++i)
    plan_inputs_[i] = bounds.nearest(i % count(inputs), 0);
  jacobians_.resize(count(steps, states, all));
  gradients_.resize(count(steps, all) + count(states));
  hessians_.resize(count(steps, all, all) + count(states, states));
  gains_.resize(count(steps, inputs, states));
  free_.resize(count(inputs));
  workspace_ = std::make_unique<Workspace>(states, inputs);
}

FeedbackGains::FeedbackGains(const FeedbackGains&) = default;
FeedbackGains::FeedbackGains(FeedbackGains&&) noexcept = default;
FeedbackGains& FeedbackGains::operator=(const FeedbackGains&) = default;
FeedbackGains& FeedbackGains::operator=(FeedbackGains&&) noexcept = default;
FeedbackGains::~FeedbackGains() = default;

FeedbackGains::Step FeedbackGains::step(int k) noexcept {
  const int all = states_ + inputs_;
  const std::span<double> jacobians = part(jacobians_, k, count(states_, all));
  return {part(plan_states_, k, count(states_)),    part(plan_inputs_, k, count(inputs_)),
          jacobians.first(count(states_, states_)), jacobians.subspan(count(states_, states_)),
          part(gradients_, k, count(all)),          part(hessians_, k, count(all, all))};
}

FeedbackGains::Terminal FeedbackGains::terminal() noexcept {
  return {std::span(plan_states_).last(count(states_)), std::span(gradients_).last(count(states_)),
          std::span(hessians_).last(count(states_, states_))};
}

std::span<const double> FeedbackGains::gain(int k) const noexcept {
  return std::span(gains_).subspan(count(k, inputs_, states_), count(inputs_, states_));
}

/// Hessian and gradient of the cost to go by state and inputs of step `k`: those of its stage cost plus those
/// of the cost to go from the next state.
void FeedbackGains::begin_step(int k) noexcept {
  const int n = states_, m = inputs_;
  Workspace& w = *workspace_;
  const Step s = step(k);
  const Map stage(s.hessian.data(), n + m, n + m), a(s.state_jacobian.data(), n, n),
      b(s.input_jacobian.data(), n, m);
  make_semidefinite(stage, w.eigen_of_all, w.of_all);
  w.product.leftCols(n) = w.value.lazyProduct(a);
  w.product.rightCols(m) = w.value.lazyProduct(b);
  w.hessian = stage;
  w.hessian.topRows(n) += a.transpose().lazyProduct(w.product);
  w.hessian.bottomRows(m) += b.transpose().lazyProduct(w.product);
  w.gradient = Vector(s.gradient.data(), n + m);
  w.gradient.head(n) += a.transpose().lazyProduct(w.value_gradient);
  w.gradient.tail(m) += b.transpose().lazyProduct(w.value_gradient);
}

/// Lists inputs that may move: but those at a bound beyond which costs fall. Returns their number.
int FeedbackGains::choose_free_inputs(int k) noexcept {
  const std::span<const double> u = part(plan_inputs_, k, count(inputs_));
  int free = 0;
  for (int i = 0; i < inputs_; ++i) {
    const double low = bounds_.low[count(i)], high = bounds_.high[count(i)],
                 slope = workspace_->gradient[states_ + i];
    const auto near = [&](double bound) {  // the plan's inputs were computed in float32
      return std::isfinite(bound) && std::abs(u[count(i)] - bound) <= 1e-6 * (1 + std::abs(bound));
    };
    if ((near(low) && slope > 0) || (near(high) && slope < 0)) continue;
    free_[count(free++)] = i;
  }
  return free;
}

/// Gain of step `k`: K = -Quu^-1 Qux for the free inputs, 0 for the others. Returns false if there is no
/// finite solution. If the cost does not depend on the free inputs, they get no gain.
bool FeedbackGains::solve_gain(int k) noexcept {
  const int n = states_, m = inputs_;
  Workspace& w = *workspace_;
  const int free = choose_free_inputs(k);
  if (free == 0) return true;
  auto quu = w.quu.topLeftCorner(free, free);
  for (int i = 0; i < free; ++i)
    for (int j = 0; j < free; ++j) quu(i, j) = w.hessian(n + free_[count(i)], n + free_[count(j)]);
  const double largest = quu.diagonal().maxCoeff();
  if (!(largest > 0)) return true;
  quu.diagonal().array() += ridge * largest;
  const Cholesky factor(quu);
  if (factor.info() != Eigen::Success) return false;
  Map gain(part(gains_, k, count(m, n)).data(), m, n);
  auto qux = w.qux.topRows(free);
  for (int i = 0; i < free; ++i) qux.row(i) = -w.hessian.row(n + free_[count(i)]).head(n);
  for (int column = 0; column < n; ++column) factor.solveInPlace(qux.col(column));
  for (int i = 0; i < free; ++i) gain.row(free_[count(i)]) = qux.row(i);
  return gain.allFinite();
}

/// The cost to go from the states of step `k`, if the inputs follow the gain.
void FeedbackGains::end_step(int k) noexcept {
  const int n = states_, m = inputs_;
  Workspace& w = *workspace_;
  const Map gain(part(gains_, k, count(m, n)).data(), m, n);
  const auto qxx = w.hessian.topLeftCorner(n, n);
  const auto qux = w.hessian.bottomLeftCorner(m, n);
  const auto quu = w.hessian.bottomRightCorner(m, m);
  w.inputs_gain = quu.lazyProduct(gain);
  w.value = 0.5 * (qxx + qxx.transpose());
  w.value += gain.transpose().lazyProduct(qux);
  w.value += qux.transpose().lazyProduct(gain);
  w.value += gain.transpose().lazyProduct(w.inputs_gain);
  w.value.triangularView<Eigen::StrictlyUpper>() = w.value.transpose();
  w.value_gradient = w.gradient.head(n);
  w.value_gradient += gain.transpose().lazyProduct(w.gradient.tail(m));
}

/// The recursion from the end of the plan to its start.
bool FeedbackGains::solve(double time_step) noexcept {
  Workspace& w = *workspace_;
  time_step_ = time_step;
  std::fill(gains_.begin(), gains_.end(), 0.0);
  bool valid = all_finite(jacobians_) && all_finite(gradients_) && all_finite(hessians_);
  if (valid) {
    const Terminal end = terminal();
    const Map hessian(end.hessian.data(), states_, states_);
    make_semidefinite(hessian, w.eigen_of_states, w.of_states);
    w.value = hessian;
    w.value_gradient = Vector(end.gradient.data(), states_);
  }
  for (int k = steps_ - 1; valid && k >= 0; --k) {
    begin_step(k);
    valid = w.hessian.allFinite() && w.gradient.allFinite() && solve_gain(k);
    if (valid) end_step(k);
  }
  if (!valid) std::fill(gains_.begin(), gains_.end(), 0.0);
  return valid;
}

void FeedbackGains::input_at(double t, std::span<const double> x, std::span<double> u) const noexcept {
  // Rounding of a multiple of the time step does not lead to the step before.
  const double position = std::isfinite(t) ? std::clamp(t / time_step_, 0.0, static_cast<double>(steps_)) : 0;
  const int k = std::min(saturate_cast<int>(position + 1e-9), steps_ - 1);
  const double share = position - k;
  const bool follow = std::isfinite(t) && all_finite(x);
  const double* const from = plan_states_.data() + count(k, states_);
  const double* const to = from + states_;
  const std::span<const double> gain = this->gain(k);
  for (int i = 0; i < inputs_; ++i) {
    const double planned = plan_inputs_[count(k, inputs_) + count(i)];
    double input = planned;
    for (int j = 0; follow && j < states_; ++j)
      input += gain[count(i, states_) + count(j)] * (x[count(j)] - (from[j] + share * (to[j] - from[j])));
    u[count(i)] = bounds_.nearest(count(i), std::isfinite(input) ? input : planned);
  }
}

}  // namespace slalom
