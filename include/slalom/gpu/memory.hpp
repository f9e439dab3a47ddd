#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <ranges>
#include <stdexcept>

#include "slalom/core/grid_view.hpp"
#include "slalom/core/network/mlp.hpp"

/// Memory of the host that a problem reads. A problem with such members has
///
///     template <class V> void visit_memory(V&& visit) const { visit(map), visit(network), visit(points); }
///
/// for members that are a `GridView`, an `Mlp`, or a `std::vector` or `std::span` of plain values.
namespace slalom::gpu {

/// A part of a problem that points to memory.
struct SharedMemory {
  std::size_t member, member_bytes;  ///< where in the problem
  std::span<const std::byte> data;   ///< memory of the host
  void* copy = nullptr;              ///< memory of the device
};

/// The cells of a map with their border.
template <int Layers>
std::span<const std::byte> memory_of_member(const GridView<Layers>& grid) {
  const auto cells = static_cast<std::size_t>(grid.rows() + 2) << grid.stride_log2();
  return std::as_bytes(std::span(grid.cells(), grid.cells() ? cells * Layers : 0));
}
/// The weights of a network.
template <int Inputs, int Outputs>
std::span<const std::byte> memory_of_member(const Mlp<Inputs, Outputs>& network) {
  return std::as_bytes(network.weights());
}
/// The values of a vector or span.
template <std::ranges::contiguous_range Values>
std::span<const std::byte> memory_of_member(const Values& values) {
  static_assert(std::is_trivially_copyable_v<std::ranges::range_value_t<Values>>,
                "slalom: a GPU takes vectors and spans of plain values");
  return std::as_bytes(std::span(values));
}

/// The memory that a problem declares. Throws std::invalid_argument if the problem has a pointer to memory of
/// this process elsewhere.
template <class P>
std::vector<SharedMemory> memory_of(const P& problem) {
  const auto* const begin = reinterpret_cast<const unsigned char*>(&problem);
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  std::vector<SharedMemory> all;
  if constexpr (requires { problem.visit_memory([](const auto&) {}); }) {
    problem.visit_memory([&](const auto& member) {
      const auto at = static_cast<std::size_t>(reinterpret_cast<const unsigned char*>(&member) - begin);
      all.push_back({at, sizeof member, memory_of_member(member)});
    });
  }
  for (std::size_t at = 0; at + sizeof page <= sizeof(P); at += alignof(std::uintptr_t)) {
    bool declared = false;
    for (const SharedMemory& m : all)
      declared = declared || (at >= m.member && at < m.member + m.member_bytes);
    std::uintptr_t word;
    unsigned char resident;
    std::memcpy(&word, begin + at, sizeof word);
    if (declared || word < 65536 || word >> 47 != 0 ||
        mincore(reinterpret_cast<void*>(word / page * page), 1, &resident) != 0)
      continue;
    throw std::invalid_argument(
        "problem: points to memory of the host at byte " + std::to_string(at) +
        ", which a GPU does not read; declare the member in visit_memory (docs/gpu.md)");
  }
  return all;
}

/// Lets a copy of the problem point to the memory of the device; returns how many words it changed.
inline int redirect(unsigned char* problem, const SharedMemory& memory) noexcept {
  const auto from = reinterpret_cast<std::uintptr_t>(memory.data.data()), bytes = memory.data.size();
  int changed = 0;
  for (std::size_t at = memory.member; bytes > 0 && at + 8 <= memory.member + memory.member_bytes; at += 8) {
    std::uintptr_t word;
    std::memcpy(&word, problem + at, sizeof word);
    if (word < from || word > from + bytes) continue;
    word = reinterpret_cast<std::uintptr_t>(memory.copy) + (word - from);
    std::memcpy(problem + at, &word, sizeof word);
    ++changed;
  }
  return changed;
}

}  // namespace slalom::gpu
