#pragma once

#include <cstdint>

#include "slalom/core/instruction_set.hpp"

/// Choices between two ways to do the same that depend on the processor. They are made by measurement, each
/// at most once, and the bits of results do not depend on them.
///
/// `active_target()` makes the choices of its instruction set when it is first called, in less than 0.2 ms.
/// The environment variable `SLALOM_TUNE` overrides them: loads, gathers, two, four, or measure. If it is
/// set, `active_target()` prints the choices to standard error, and throws std::invalid_argument if it is set
/// to none of these.
namespace slalom::simd {

/// How the four values of a cell are read with AVX-512. Which is faster depends on the processor: on some,
/// microcode against gather data sampling slows gathers down.
enum class CellAccess : std::uint8_t {
  loads,   ///< a load of 128 bits for each cell, then a transpose
  gathers  ///< gathers of 64 bits
};

/// "loads" or "gathers".
const char* name(CellAccess access) noexcept;

/// How cells are read, and what the choice is based on.
struct CellAccessChoice {
  CellAccess access = CellAccess::loads;  ///< that kernels use
  double loads_ns = 0;                    ///< for a step of 16 rollouts; 0 if not measured
  double gathers_ns = 0;                  ///< for a step of 16 rollouts; 0 if not measured
};

/// Measures rollouts over a map with both ways to read its cells, alternately, in less than 0.2 ms, and takes
/// the faster one; gathers if they are at most 3 % slower, since they are fewer instructions. Without AVX-512
/// there is no choice: loads.
CellAccessChoice measure_cell_access() noexcept;

/// How kernels read cells.
CellAccessChoice active_cell_access();

/// Changes how kernels read cells, for tests and benchmarks.
void set_cell_access(CellAccess access) noexcept;

/// How many packs of rollouts of four lanes without fused multiply-add are in flight. With 16 registers, that
/// is with `Sse4` and on x86-64 with `Generic`, it depends on the processor whether more in flight are worth
/// the registers.
enum class PacksInFlight : std::uint8_t {
  two,  ///< what a pack sees is looked up when it takes its step
  four  ///< what a pack sees is looked up while the pack before it takes its step
};

/// "two" or "four".
const char* name(PacksInFlight packs) noexcept;

/// How many packs are in flight, and what the choice is based on.
struct PacksInFlightChoice {
  PacksInFlight packs = PacksInFlight::two;  ///< that kernels use
  double two_ns = 0;                         ///< for a step of 16 rollouts; 0 if not measured
  double four_ns = 0;                        ///< for a step of 16 rollouts; 0 if not measured
};

/// Measures rollouts over a map with two and with four packs in flight, alternately, in less than 0.2 ms, and
/// takes the faster way; two if they are at most 3 % slower. With other instruction sets than `sse4`, and
/// than `generic` on x86-64, there is no choice.
PacksInFlightChoice measure_packs_in_flight(Target target) noexcept;

/// How many packs of four lanes are in flight.
PacksInFlightChoice active_packs_in_flight();

/// Changes how many packs are in flight, for tests and benchmarks.
void set_packs_in_flight(PacksInFlight packs) noexcept;

namespace detail {

/// What AVX-512 kernels use: a CellAccess.
extern std::uint8_t cell_access;
/// What kernels of four lanes use: a PacksInFlight.
extern std::uint8_t packs_in_flight;

/// Whether `packs_in_flight` is four.
inline bool four_packs_in_flight() noexcept {
  return __atomic_load_n(&packs_in_flight, __ATOMIC_RELAXED) ==
         static_cast<std::uint8_t>(PacksInFlight::four);
}

}  // namespace detail

}  // namespace slalom::simd
