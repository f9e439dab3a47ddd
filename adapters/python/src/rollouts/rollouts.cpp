// The code that computes, without Python: the rollouts of built-in problems and of networks.
#include "built_in_problems.hpp"
#include "network_model.hpp"

namespace slalom {
SLALOM_ROLLOUTS_OF(Arm);
SLALOM_ROLLOUTS_OF(Car);
SLALOM_ROLLOUTS_OF(CartPole);
SLALOM_ROLLOUTS_OF(DifferentialDrive);
SLALOM_ROLLOUTS_OF(Pendulum);
SLALOM_ROLLOUTS_OF(Quadrotor);
}  // namespace slalom

namespace slalom::python {
namespace {

struct NetworkRollout {
  template <class Target>
  SLALOM_KERNEL static void run(const NetworkModel& m, const float* start, const SequenceBatch& batch,
                                int first, int count, float* costs, std::uint8_t* collided) {
    using F = Pack<Target>;
    for (int s = first; s < first + count; s += F::lanes) {
      F x[most], u[most], total(0.0f);
      mask_t<F> hit(false);
      for (int i = 0; i < m.states; ++i) x[i] = F(start[i]);
      for (int k = 0; k <= batch.steps(); ++k) {
        const bool last = k == batch.steps();
        const StateCost<F> cost = state_cost(m, last ? m.terminal_weights : m.state_weights, x);
        total = total + cost.distance + cost.obstacles + cost.field;
        hit = hit || cost.collided;
        if (last) break;
        for (int i = 0; i < m.inputs; ++i) u[i] = F::load(batch.row(k, i) + s);
        total = total + input_cost(m, u);
        take_step(m, u, x);
      }
      total.store(costs + s);
      hit.store(collided + s);
    }
  }
};

}  // namespace

void roll_out_network(const NetworkModel& m, const float* start, const SequenceBatch& batch, int first,
                      int count, float* costs, std::uint8_t* collided) noexcept {
  simd::dispatch<NetworkRollout>(m, start, batch, first, count, costs, collided);
}

}  // namespace slalom::python
