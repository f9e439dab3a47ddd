#include "vehicle/estimation/hypothesis_bank.hpp"

#include <cmath>

#include "slalom/core/dispatch.hpp"

namespace slalom::vehicle::detail {
namespace {

struct PredictAll {
  template <class Target>
  SLALOM_KERNEL static void run(const BankInput& in) {
    using F = Pack<Target>;
    const F period(in.period);
    const F sine(__builtin_sinf(in.yaw)), cosine(__builtin_cosf(in.yaw));
    for (int d = 0; d < in.delays; ++d)
      for (int g = 0; g < in.gains; ++g)
        for (int f = 0; f < in.frictions; f += F::lanes) {
          const F gain(in.gain[g]), friction = F::load(in.friction + f);
          SingleTrackState<F> s{F(0.0f),        F(0.0f),      F(0.0f), F(in.speed[0]), gain * F(in.angles[d]),
                                F(in.yaw_rate), F(in.lateral)};
          for (int k = 0; k < in.steps; ++k) {
            s.speed = F(in.speed[k]);
            const F angle = gain * F(in.angles[(k + 1) * in.delays + d]);
            s = in.dynamics->advance(s, angle, F(in.acceleration[k]), friction, period);
          }
          const F dx = s.x - F(in.x), dy = s.y - F(in.y);
          const int at = (d * in.gains + g) * in.frictions + f;
          (cosine * dy - sine * dx).store(in.lateral_error + at);
          (s.yaw - F(in.yaw)).store(in.yaw_error + at);
        }
  }
};

}  // namespace

void predict_all(const BankInput& input) noexcept {
  simd::dispatch<PredictAll>(input);
}

}  // namespace slalom::vehicle::detail
