#pragma once

#include <cstdint>
#include <vector>

#include "slalom/maps/occupancy_grid.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {

/// Writes the block with a map: runs of equal cells, the value in the upper 8 bits, the length in the
/// lower 24.
inline void put_grid(FrameWriter& to, const maps::OccupancyGrid& grid) {
  std::vector<std::uint32_t> runs;
  for (const maps::Occupancy cell : grid.cells) {
    const auto value = static_cast<std::uint32_t>(cell);
    if (runs.empty() || runs.back() >> 24 != value || (runs.back() & 0xffffffu) == 0xffffffu)
      runs.push_back(value << 24);
    ++runs.back();
  }
  to.begin(Block::grid);
  to.put(static_cast<std::uint32_t>(grid.width));
  to.put(static_cast<std::uint32_t>(grid.height));
  to.put(grid.resolution);
  to.put_pose(grid.origin);
  to.put(static_cast<std::uint32_t>(runs.size()));
  for (const std::uint32_t run : runs) to.put(run);
  to.end();
}

}  // namespace slalom::view
