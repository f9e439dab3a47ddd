// The code that computes, without Python: the rollouts of built-in problems.
#include "built_in_problems.hpp"

namespace slalom {
SLALOM_ROLLOUTS_OF(Arm);
SLALOM_ROLLOUTS_OF(Car);
SLALOM_ROLLOUTS_OF(CartPole);
SLALOM_ROLLOUTS_OF(DifferentialDrive);
SLALOM_ROLLOUTS_OF(Pendulum);
SLALOM_ROLLOUTS_OF(Quadrotor);
}  // namespace slalom
