#include "core/cell_access.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/grid_view.hpp"

namespace slalom::simd {
namespace detail {

std::uint8_t cell_access = static_cast<std::uint8_t>(CellAccess::loads);

}  // namespace detail

namespace {

/// Cars that drive over a map, as rollouts do. Reads are measured among the arithmetic of a rollout, with
/// which they compete for the processor.
struct DriveOverMap {
  static constexpr int steps = 20, packs = 4, samples = packs * padding;

  template <class Target>
  SLALOM_KERNEL static void run(const GridView<4>& map, const float* steering, float* costs) {
    using F = Pack<Target>;
    struct Car {
      F x = F(0.0f), y = F(0.0f), yaw = F(0.0f), cost = F(0.0f);
    };
    for (int first = 0; first < samples; first += packs * F::lanes) {
      Car cars[packs];
      for (int k = 0; k < steps; ++k) {
        for (int j = 0; j < packs; ++j)
          drive(map, F::load(steering + k * samples + first + j * F::lanes), cars[j]);
      }
      for (int j = 0; j < packs; ++j) cars[j].cost.store(costs + first + j * F::lanes);
    }
  }

 private:
  template <class F, class Car>
  SLALOM_INLINE_CALLS static void drive(const GridView<4>& map, const F& steer, Car& car) {
    const CellValues<F> cell = look_up(map, car.x, car.y);
    F sine(0.0f), cosine(0.0f);
    sin_cos(car.yaw, sine, cosine);
    car.cost += square((car.x - cell.a) * cosine) + square((car.y - cell.b) * sine) +
                square(cell.c - car.yaw) + cell.d + square(steer);
    car.x += F(0.1f) * cosine;
    car.y += F(0.1f) * sine;
    car.yaw += F(0.5f) * tan(steer);
  }
};

/// Drives from the middle of a map of 64 kB. Does not allocate: the choice may be made within a solve.
class Workload {
 public:
  Workload() {
    for (std::size_t i = 0; i < std::size(cells_); ++i) cells_[i] = static_cast<float>(i % 7);
    std::uint32_t state = 1;
    for (float& steer : steering_) {
      state = 1664525 * state + 1013904223;  // D. E. Knuth's linear congruential generator
      steer = static_cast<float>(state >> 8) / (1 << 24) - 0.5f;
    }
  }
  /// ns for a step of 16 rollouts.
  double time(KernelPointer<DriveOverMap> drive, CellAccess access) noexcept {
    constexpr int side = (1 << side_log2) - 2;
    set_cell_access(access);
    const auto begin = std::chrono::steady_clock::now();
    drive({cells_, side, side, side_log2, 0.1, 0, 0}, steering_, costs_);
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;
    return elapsed.count() / (DriveOverMap::steps * DriveOverMap::packs);
  }

 private:
  static constexpr int side_log2 = 6;
  alignas(64) float cells_[4 << (2 * side_log2)];
  float steering_[DriveOverMap::steps * DriveOverMap::samples];
  float costs_[DriveOverMap::samples];
};

CellAccessChoice active_choice;

}  // namespace

const char* name(CellAccess access) noexcept {
  return access == CellAccess::gathers ? "gathers" : "loads";
}

void set_cell_access(CellAccess access) noexcept {
  __atomic_store_n(&detail::cell_access, static_cast<std::uint8_t>(access), __ATOMIC_RELAXED);
}

CellAccessChoice measure_cell_access() noexcept {
  if (!supported(Target::avx512)) return {};
  constexpr int rounds = 14;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto before = static_cast<CellAccess>(__atomic_load_n(&detail::cell_access, __ATOMIC_RELAXED));
  const KernelPointer<DriveOverMap> drive = kernel<DriveOverMap>(Target::avx512);
  Workload workload;
  CellAccessChoice choice{CellAccess::loads, infinite, infinite};
  for (int round = 0; round < rounds; ++round) {
    choice.loads_ns = std::min(choice.loads_ns, workload.time(drive, CellAccess::loads));
    choice.gathers_ns = std::min(choice.gathers_ns, workload.time(drive, CellAccess::gathers));
  }
  if (choice.gathers_ns <= 1.03 * choice.loads_ns) choice.access = CellAccess::gathers;
  set_cell_access(before);
  return choice;
}

void detail::choose_cell_access(Target target) {
  const char* forced = std::getenv("SLALOM_TUNE");
  const std::string_view wanted = forced ? forced : "";
  for (const CellAccess access : {CellAccess::loads, CellAccess::gathers})
    if (wanted == name(access)) active_choice.access = access;
  const bool named = wanted == "loads" || wanted == "gathers";
  if (!wanted.empty() && !named && wanted != "measure")
    throw std::invalid_argument("SLALOM_TUNE=" + std::string(wanted) +
                                ": not one of loads, gathers, measure");
  if (target == Target::avx512 && !named) active_choice = measure_cell_access();
  set_cell_access(active_choice.access);
  if (wanted.empty()) return;
  // The only output of the library, for which SLALOM_TUNE asks.
  std::fprintf(stderr, "slalom: cells are read by %s", name(active_choice.access));
  if (active_choice.loads_ns > 0) {
    std::fprintf(stderr, " (16 rollout steps: loads %.1f ns, gathers %.1f ns)", active_choice.loads_ns,
                 active_choice.gathers_ns);
  }
  std::fprintf(stderr, "\n");
}

CellAccessChoice active_cell_access() {
  active_target();
  return active_choice;
}

}  // namespace slalom::simd
