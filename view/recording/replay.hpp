#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

/// A replay: the messages of a live drive in their order, in segments that are compressed one by one. A
/// message is stored as its kind (a byte: 0 text, 1 binary), its length (u32) and its bytes. They are small
/// unless everything is asked for: what a reader of a drive looks at, not what a developer of a solver does.
namespace slalom::view {

/// Cuts messages into segments.
class ReplaySegments {
 public:
  using Take = std::function<void(std::string segment)>;

  /// `take` gets each segment, compressed with gzip, when it is full or at `finish`. Without `everything`,
  /// the replay is small: every other frame, as small_frame() makes it.
  explicit ReplaySegments(Take take, bool everything = false)
      : take_(std::move(take)), everything_(everything) {}

  void add_text(std::string_view message);
  void add_course(std::string_view message) { add(1, message); }
  void add_frame(std::string_view message);
  void finish();

 private:
  void add(char kind, std::string_view message);

  Take take_;
  bool everything_;
  std::string segment_;
  int frames_ = 0, steps_ = 0;  ///< frames of the segment; control steps
};

/// Returns the page with a replay inside: one file that needs no server. `page`: HTML.
std::string replay_page(std::string page, const std::vector<std::string>& segments);

/// Returns the segments of an MCAP recording. Of one that was cut: those that are whole, and `lost` receives
/// the number of bytes after the last one. Throws IoError if it is not a recording, or cut without `lost`.
std::vector<std::string> load_replay(const std::string& file, std::uint64_t* lost = nullptr);

inline constexpr int small_stride = 2;        ///< control steps for each frame of a small recording
inline constexpr int small_scene_stride = 6;  ///< control steps for each of its scenes for other programs
inline constexpr int small_candidates = 20;   ///< candidates of its frames: the heaviest, and others
inline constexpr int small_beams = 6;         ///< beams of a scan for each that is kept

/// Returns a frame (docs/live-view.md) with fewer candidates and beams, with figures of the precision of a
/// float, and without guides and cost map.
std::string small_frame(std::string_view frame);

}  // namespace slalom::view
