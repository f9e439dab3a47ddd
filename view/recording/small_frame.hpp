#pragma once

#include <string>
#include <string_view>

/// Recordings are small unless everything is asked for: what a reader of a drive looks at, not what a
/// developer of a solver does.
namespace slalom::view {

inline constexpr int small_stride = 2;        ///< control steps for each frame of a small recording
inline constexpr int small_scene_stride = 6;  ///< control steps for each of its scenes for other programs
inline constexpr int small_candidates = 20;   ///< candidates of its frames: the heaviest, and others
inline constexpr int small_beams = 6;         ///< beams of a scan for each that is kept

/// Returns a frame (docs/live-view.md) with fewer candidates and beams, with figures of the precision of a
/// float, and without guides and cost map.
std::string small_frame(std::string_view frame);

}  // namespace slalom::view
