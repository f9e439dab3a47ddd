#include "vehicle/estimation/hypothesis_bank.hpp"

#include "slalom/core/dispatch.hpp"

namespace slalom::vehicle::detail {
namespace {

struct PredictAll {
  template <class Target>
  SLALOM_KERNEL static void run(const SingleTrackDynamics& dynamics, const HypothesisGrid& grid,
                                const Stretch& in, float* lateral_error, float* yaw_error) {
    using F = Pack<Target>;
    const F period(in.period);
    const F sine(__builtin_sinf(in.yaw)), cosine(__builtin_cosf(in.yaw));
    std::size_t at = 0;
    for (std::size_t d = 0; d < HypothesisGrid::delays; ++d)
      for (const float each : grid.gain)
        for (std::size_t f = 0; f < HypothesisGrid::frictions; f += F::lanes, at += F::lanes) {
          const F gain(each), friction = F::load(grid.friction.data() + f);
          SingleTrackState<F> s{
              F(0.0f),        F(0.0f),      F(0.0f), F(in.speed[0]), gain * F(in.angle[0][d]) + F(in.offset),
              F(in.yaw_rate), F(in.lateral)};
          for (std::size_t k = 0; k < static_cast<std::size_t>(in.steps); ++k) {
            s.speed = F(in.speed[k]);
            s = dynamics.advance(s, gain * F(in.angle[k + 1][d]) + F(in.offset), F(in.acceleration[k]),
                                 friction, period);
          }
          const F dx = s.x - F(in.x), dy = s.y - F(in.y);
          (cosine * dy - sine * dx).store(lateral_error + at);
          (s.yaw - F(in.yaw)).store(yaw_error + at);
        }
  }
};

}  // namespace

void predict_all(const SingleTrackDynamics& dynamics, const HypothesisGrid& grid, const Stretch& stretch,
                 float* lateral_error, float* yaw_error) noexcept {
  simd::dispatch<PredictAll>(dynamics, grid, stretch, lateral_error, yaw_error);
}

}  // namespace slalom::vehicle::detail
