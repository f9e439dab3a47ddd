#pragma once

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"

/// The rollouts of a built-in problem, which rollouts.cpp compiles.
#define SLALOM_ROLLOUTS_OF(Name)                                      \
  template simd::KernelPointer<detail::RolloutKernel<problems::Name>> \
  simd::kernel<detail::RolloutKernel<problems::Name>>(simd::Target)

namespace slalom {
extern SLALOM_ROLLOUTS_OF(Arm);
extern SLALOM_ROLLOUTS_OF(Car);
extern SLALOM_ROLLOUTS_OF(CartPole);
extern SLALOM_ROLLOUTS_OF(DifferentialDrive);
extern SLALOM_ROLLOUTS_OF(Pendulum);
extern SLALOM_ROLLOUTS_OF(Quadrotor);
}  // namespace slalom
