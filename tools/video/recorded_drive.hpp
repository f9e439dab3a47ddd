#pragma once

#include <string>
#include <string_view>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::tools {

/// A sample of a controller.
struct RecordedCandidate {
  float cost = 0, weight = 0;
  bool collided = false;
  std::vector<maps::Point> points;
};

/// A body of the world.
struct RecordedBody {
  int kind = 0;  ///< 0 driven, 1 parked car, 2 box, 3 disc, 4 opponent
  bool collided = false;
  sim::Box box{};
};

/// The part of a control step that a video shows.
struct RecordedStep {
  std::string method;
  maps::Pose car;
  int collisions = 0;  ///< since the beginning of the lap
  std::vector<RecordedCandidate> candidates;
  std::vector<std::vector<maps::Point>> guides;  ///< where they ended
  std::vector<maps::Point> nominal, plan;
  std::vector<RecordedBody> bodies;  ///< the driven car is the first
};

/// A drive that was recorded (docs/recording.md), with the second controller if there was one.
class RecordedDrive {
 public:
  /// Reads a recording in MCAP; of one that was cut, as far as it is whole. Throws IoError.
  explicit RecordedDrive(const std::string& file);

  /// The steps of a moment: that of the car and, if there is a ghost, that of the ghost in its own world.
  /// Throws IoError if they are damaged.
  std::vector<RecordedStep> at(std::size_t frame) const;
  std::size_t frames() const { return frames_.size(); }
  double duration() const { return period * static_cast<double>(frames_.size()); }

  std::string title;  ///< course and seed
  double period = 0;  ///< s between two frames
  maps::OccupancyGrid map;
  std::vector<maps::Point> path;
  bool closed = false;  ///< whether the path leads back to its beginning

 private:
  void take_text(std::string_view text);
  void take_course(std::string_view message);
  RecordedStep step(std::string_view message) const;

  std::string file_;
  std::vector<std::string> scalars_, methods_, frames_;
};

}  // namespace slalom::tools
