#include "core/tuning.hpp"

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
#include "slalom/core/rollout.hpp"

namespace slalom::simd {
namespace detail {

std::uint8_t cell_access = static_cast<std::uint8_t>(CellAccess::loads);
std::uint8_t packs_in_flight = static_cast<std::uint8_t>(PacksInFlight::two);

}  // namespace detail

namespace {

/// A car that drives over two maps, as a vehicle problem does: reads of cells and packs in flight compete
/// with its arithmetic for the processor.
struct DriveOverMap {
  template <class T>
  struct State {
    T x, y, yaw, steer;  // m, m, rad, rad
  };
  template <class T>
  struct Seen {
    CellValues<T> path;
    T obstacle;
  };
  static constexpr int inputs = 1;  // steering, rad
  GridView<4> path;
  GridView<1> obstacles;

  template <class T>
  Seen<T> look_up(const State<T>& s) const {
    return {slalom::look_up(path, s.x, s.y), slalom::look_up(obstacles, s.x, s.y)};
  }
  template <class T>
  State<T> step(const State<T>& s, const Seen<T>&, const Input<T, 1>& u) const {
    T sin_steer(0.0f), cos_steer(0.0f), sin_yaw(0.0f), cos_yaw(0.0f);
    sin_cos_half_turn(s.steer, sin_steer, cos_steer);
    sin_cos(s.yaw, sin_yaw, cos_yaw);
    const T opposite = T(0.4f) * sin_steer;
    const T scale = T(0.05f) * reciprocal_sqrt(cos_steer * cos_steer + opposite * opposite);
    const T along = scale * cos_steer, across = scale * opposite;
    return {s.x + (along * cos_yaw - across * sin_yaw), s.y + (along * sin_yaw + across * cos_yaw),
            s.yaw + T(7.0f) * across, s.steer + T(0.4f) * (u[0] - s.steer)};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Seen<T>& seen, const Input<T, 1>&) const {
    const T error = select(seen.path.d > T(3.0f), seen.path.b, wrap_angle(s.yaw - seen.path.c));
    return {square(seen.path.a) + square(error) + seen.obstacle, seen.obstacle > T(5.0f)};
  }
  template <class T>
  Cost<T> terminal_cost(const State<T>&, const Seen<T>& seen) const {
    return {seen.obstacle, seen.obstacle > T(5.0f)};
  }
};

/// The rollouts of every problem, without a batch, which would allocate.
struct MeasuredRollouts {
  template <class Target>
  SLALOM_KERNEL static void run(const DriveOverMap& problem, const float* initial,
                                const slalom::detail::InputRows& rows, int count, float* costs,
                                std::uint8_t* collided) {
    slalom::detail::roll_out_range<Target>(problem, initial, rows, 0, count, costs, collided);
  }
};

/// Drives from the middle of a map of 16 kB. Does not allocate: the choice may be made within a solve.
class Workload {
 public:
  explicit Workload(Target target) : roll_out_(kernel<MeasuredRollouts>(target)) {
    constexpr int side = (1 << side_log2) - 2;
    for (std::size_t i = 0; i < std::size(cells_); ++i) cells_[i] = static_cast<float>(i % 7);
    std::uint32_t state = 1;
    for (float& steer : steering_) {
      state = 1664525 * state + 1013904223;  // D. E. Knuth's linear congruential generator
      steer = static_cast<float>(state >> 8) / (1 << 24) - 0.5f;
    }
    problem_.path = {cells_, side, side, side_log2, 0.1, 0, 0};
    problem_.obstacles = {cells_, side, side, side_log2, 0.1, 0, 0};
  }
  /// Sets `best_ns` to the time of a step of 16 rollouts if it is less.
  void measure(double& best_ns) noexcept {
    constexpr float start[4] = {};
    const auto begin = std::chrono::steady_clock::now();
    roll_out_(problem_, start, {steering_, samples, steps}, samples, costs_, collided_);
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - begin;
    best_ns = std::min(best_ns, 16 * elapsed.count() / (steps * samples));
  }

 private:
  static constexpr int side_log2 = 5, steps = 20, samples = 4 * padding;
  KernelPointer<MeasuredRollouts> roll_out_;
  DriveOverMap problem_;
  alignas(64) float cells_[4 << (2 * side_log2)];
  alignas(64) float steering_[steps * samples];
  alignas(64) float costs_[samples];
  std::uint8_t collided_[samples];
};

constexpr double infinite = std::numeric_limits<double>::infinity();

bool chooses_packs(Target target) noexcept {
  return target == Target::sse4 ? slalom::detail::chooses_packs<Sse4>
                                : target == Target::generic && slalom::detail::chooses_packs<Generic>;
}

CellAccessChoice cells;
PacksInFlightChoice flight;

/// Prints a choice with its times if they were measured: the only output of the library, for which
/// SLALOM_TUNE asks.
void print(const char* what, const char* chosen, const char* one, double one_ns, const char* other,
           double other_ns) {
  std::fprintf(stderr, "slalom: %s%s", what, chosen);
  if (one_ns > 0)
    std::fprintf(stderr, " (16 rollout steps: %s %.1f ns, %s %.1f ns)", one, one_ns, other, other_ns);
  std::fprintf(stderr, "\n");
}

}  // namespace

const char* name(CellAccess access) noexcept {
  return access == CellAccess::gathers ? "gathers" : "loads";
}

const char* name(PacksInFlight packs) noexcept {
  return packs == PacksInFlight::four ? "four" : "two";
}

void set_cell_access(CellAccess access) noexcept {
  __atomic_store_n(&detail::cell_access, static_cast<std::uint8_t>(access), __ATOMIC_RELAXED);
}

void set_packs_in_flight(PacksInFlight packs) noexcept {
  __atomic_store_n(&detail::packs_in_flight, static_cast<std::uint8_t>(packs), __ATOMIC_RELAXED);
}

CellAccessChoice measure_cell_access() noexcept {
  if (!supported(Target::avx512)) return {};
  const auto before = static_cast<CellAccess>(__atomic_load_n(&detail::cell_access, __ATOMIC_RELAXED));
  Workload workload(Target::avx512);
  CellAccessChoice choice{CellAccess::loads, infinite, infinite};
  for (int round = 0; round < 14; ++round) {
    set_cell_access(CellAccess::loads);
    workload.measure(choice.loads_ns);
    set_cell_access(CellAccess::gathers);
    workload.measure(choice.gathers_ns);
  }
  if (choice.gathers_ns <= 1.03 * choice.loads_ns) choice.access = CellAccess::gathers;
  set_cell_access(before);
  return choice;
}

PacksInFlightChoice measure_packs_in_flight(Target target) noexcept {
  if (!chooses_packs(target) || !supported(target)) return {};
  const auto before = static_cast<PacksInFlight>(__atomic_load_n(&detail::packs_in_flight, __ATOMIC_RELAXED));
  Workload workload(target);
  PacksInFlightChoice choice{PacksInFlight::two, infinite, infinite};
  for (int round = 0; round < 6; ++round) {  // a step takes several times as long as with AVX-512
    set_packs_in_flight(PacksInFlight::two);
    workload.measure(choice.two_ns);
    set_packs_in_flight(PacksInFlight::four);
    workload.measure(choice.four_ns);
  }
  if (choice.two_ns > 1.03 * choice.four_ns) choice.packs = PacksInFlight::four;
  set_packs_in_flight(before);
  return choice;
}

void detail::choose(Target target) {
  const char* forced = std::getenv("SLALOM_TUNE");
  const std::string_view wanted = forced ? forced : "";
  bool named = false;
  const auto take = [&](auto option, auto& choice) {
    if (wanted != name(option)) return;
    choice = option;
    named = true;
  };
  for (const CellAccess access : {CellAccess::loads, CellAccess::gathers}) take(access, cells.access);
  for (const PacksInFlight packs : {PacksInFlight::two, PacksInFlight::four}) take(packs, flight.packs);
  if (!wanted.empty() && !named && wanted != "measure")
    throw std::invalid_argument("SLALOM_TUNE=" + std::string(wanted) +
                                ": not one of loads, gathers, two, four, measure");
  if (target == Target::avx512 && !named) cells = measure_cell_access();
  if (chooses_packs(target) && !named) flight = measure_packs_in_flight(target);
  set_cell_access(cells.access);
  set_packs_in_flight(flight.packs);
  if (wanted.empty()) return;
  print("cells are read by ", name(cells.access), "loads", cells.loads_ns, "gathers", cells.gathers_ns);
  if (chooses_packs(target))
    print("packs in flight: ", name(flight.packs), "two", flight.two_ns, "four", flight.four_ns);
}

CellAccessChoice active_cell_access() {
  active_target();
  return cells;
}

PacksInFlightChoice active_packs_in_flight() {
  active_target();
  return flight;
}

}  // namespace slalom::simd
