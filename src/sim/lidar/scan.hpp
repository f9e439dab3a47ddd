#pragma once

#include "slalom/core/dispatch.hpp"

namespace slalom::sim::detail {

/// Beams that are walked together as far as no wall is near any of them.
inline constexpr int cone_beams = 16;
/// Beam arrays and cone arrays are padded to whole multiples of this.
inline constexpr int scan_padding = 64;

/// A scan of walls, in cells of the grid with its ring.
struct ScanTask {
  const std::int16_t* clearance;
  int stride;
  float x, y;            ///< position of the sensor, cells, the ring's corner at (0, 0)
  float cosine, sine;    ///< direction of the sensor's yaw in the grid
  const float* cosines;  ///< per beam, in the sensor's frame
  const float* sines;
  int beams;                  ///< without padding
  const float* cone_cosines;  ///< per cone, of its middle
  const float* cone_sines;
  float cone_width;  ///< rad, from a cone's middle to its outermost beam
  float most;        ///< cells, longest range
  float beyond;      ///< cells, how far past a cell's border the next one surely is
  float resolution;  ///< m per cell
  float range_max;   ///< m
  float* ranges;     ///< out, m, with room for the padding
};

/// A body to look for in beams [first, last].
struct CastTask {
  float x, y;            ///< m, of the sensor in the body's frame
  float cosine, sine;    ///< direction of the sensor's yaw in the body's frame
  const float* cosines;  ///< per beam, in the sensor's frame
  const float* sines;
  float half_length, half_width;  ///< m, of a box
  float radius;                   ///< m, above 0 for a disc
  int first, last;
  float* ranges;  ///< ranges, in and out, m
};

struct NoiseTask {
  std::uint32_t key0, key1;
  float deviation;           ///< m
  float most;                ///< m
  std::uint32_t lost_below;  ///< share of lost beams, times 2^32
  int count;
  float* ranges;  ///< ranges, in and out, m, with room for the padding
};

/// The kernels of scans for one instruction set. All instruction sets give the same bits.
struct ScanKernels {
  void (*walls)(const ScanTask&);
  void (*cast)(const CastTask&);
  void (*noise)(const NoiseTask&);
};

/// Returns the kernels for an instruction set, which the processor must support.
ScanKernels scan_kernels(simd::Target target);
/// Returns the kernels for simd::active_target(). Throws as that does.
const ScanKernels& scan_kernels();

}  // namespace slalom::sim::detail
