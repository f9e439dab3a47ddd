#pragma once

#include "view/protocol/frame_reader.hpp"
#include "view/recording/foxglove_messages.hpp"
#include "view/recording/mcap_writer.hpp"
#include "view/recording/replay.hpp"

namespace slalom::view {

/// The facts that a recording contains about itself.
struct RecorderOptions {
  std::string program = "slalom";                         ///< name of the program that writes the recording
  std::map<std::string, std::string> settings{};          ///< stored as the metadata "slalom"
  double lidar_angle_min = 0, lidar_angle_increment = 0;  ///< rad
  bool everything = false;  ///< all candidates, guides and cost maps of every step; else a small recording
  bool wall_clock = false;  ///< records wall-clock times; without them the same drive gives the same bytes
};

/// Writes a drive as an MCAP file (docs/recording.md): topics with Foxglove's messages for other programs,
/// and the messages of the live view as attachments, which the page replays.
class Recorder {
 public:
  Recorder(std::ostream& stream, RecorderOptions options);

  /// Begins another drive, whose times start at 0 again; it is recorded after the previous one.
  void begin_drive();
  /// Adds a text message to the page: hello, options or state.
  void add_text(std::string_view json);
  /// Adds the message with the map and line of the course.
  void add_course(std::string_view message);
  /// Adds the message of a control step.
  void add_frame(std::string_view frame);
  /// Closes the file's structure.
  void finish();

 private:
  /// The channels, in the order in which they are added.
  enum class Topic { transform, map, course, scan, cars, plan, tick, times };

  void add(Topic topic, const Json& message);
  void attach(const std::string& segment);
  std::string without_wall_clock(std::string_view frame, const FrameReader& reader) const;
  static std::vector<std::array<double, 6>> plan_of(const FrameReader& reader);
  void add_tick(const FrameReader& reader, const std::vector<double>& scalars);
  void add_scene(const FrameReader& reader);
  void add_scan(const FrameReader& reader);
  void add_cars(const FrameReader& reader);
  void add_plan(const FrameReader& reader);

  RecorderOptions options_;
  mcap::Writer writer_;
  std::vector<std::uint16_t> channels_;
  ReplaySegments replay_;
  int segments_ = 0, steps_ = 0;
  std::uint64_t time_ = 0, offset_ = 0;  ///< ns
};

}  // namespace slalom::view
