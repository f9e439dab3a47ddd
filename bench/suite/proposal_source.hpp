#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "slalom/slalom.hpp"

/// Proposals of the solves of a run: by iterative LQR, and drawn from the C-Uniform law of a task.
namespace slalom::suite {

/// The law of a task without one. A law is made by `make_law(controller)` and draws by `law(x, random)`.
struct NoLaw {
  template <class C>
  auto operator()(const C&) const {
    return [](const auto&, RandomStream&) { return std::span<const typename C::Inputs>{}; };
  }
};

/// The law of a task whose inputs make the same motion from every state, apart from where it starts and what
/// is added to it: of a vehicle in every pose, and of a point mass, whose motion is linear in its inputs.
template <class Locate, std::size_t N>
auto law_from_rest(Locate locate, const CellAxis (&axes)[N], const CUniformOptions& options) {
  return [=, axes = std::to_array(axes)](const auto& controller) {
    CellAxis copy[N];
    std::copy(axes.begin(), axes.end(), copy);
    return [law = CUniform(controller, {}, locate, copy, options)](
               const auto&, RandomStream& random) mutable { return law.draw(random); };
  };
}

/// The cells of a vehicle: position, m, and heading, rad.
inline auto pose_law(double metres, double radians, const CUniformOptions& options) {
  return law_from_rest(
      [](const auto& x) {
        return std::array{x.x, x.y, x.yaw};
      },
      {{metres}, {metres}, {radians, 2 * std::numbers::pi}}, options);
}

/// The cells of a point mass in the plane: position, m, and speeds, m/s.
inline auto point_law(double metres, double metres_per_second, const CUniformOptions& options) {
  return law_from_rest(
      [](const auto& x) {
        return std::array{x.x, x.y, x.speed_x, x.speed_y};
      },
      {{metres}, {metres}, {metres_per_second}, {metres_per_second}}, options);
}

/// A source of proposals for a controller of type C.
template <class C, class MakeLaw>
class ProposalSource {
 public:
  /// `c_uniform` sequences from the law, and one by iterative LQR if `ilqr_iterations` is above 0.
  ProposalSource(const C& controller, const MakeLaw& make_law, int ilqr_iterations, int c_uniform)
      : ilqr_(controller, {std::max(ilqr_iterations, 1)}),
        with_ilqr_(ilqr_iterations > 0),
        c_uniform_(c_uniform) {
    if (c_uniform_ > 0) law_.emplace(make_law(controller));
    if (with_ilqr_ || c_uniform_ > 0) proposals_.emplace(controller, c_uniform_ + (with_ilqr_ ? 1 : 0));
  }

  /// Starts a run.
  void restart(std::uint64_t seed) {
    ilqr_.start_from({});
    random_ = RandomStream({.seed = seed});
  }

  /// The proposals from state `x`, `elapsed` s after the last ones.
  SequenceList propose(const C& controller, const typename C::State& x, double elapsed) {
    if (!proposals_) return {};
    proposals_->clear();
    if (with_ilqr_) proposals_->add(ilqr_.improve(controller.problem(), x, elapsed));
    for (int i = 0; i < c_uniform_; ++i) proposals_->add((*law_)(x, random_));
    return *proposals_;
  }

  /// Takes the plan of the solve.
  void learn(std::span<const typename C::Inputs> plan) {
    if (with_ilqr_) ilqr_.start_from(plan);
  }

 private:
  decltype(Ilqr(std::declval<const C&>())) ilqr_;
  bool with_ilqr_;
  int c_uniform_;
  std::optional<decltype(std::declval<const MakeLaw&>()(std::declval<const C&>()))> law_;
  std::optional<decltype(Proposals(std::declval<const C&>(), 1))> proposals_;
  RandomStream random_{RandomKey{}};
};

}  // namespace slalom::suite
