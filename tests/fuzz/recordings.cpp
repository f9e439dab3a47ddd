// Recordings in MCAP: those from which a car is identified, and those that are replayed.
#include <cmath>
#include <sstream>

#include "fuzz/target.hpp"
#include "json/json.hpp"
#include "slalom/vehicle/model/identification.hpp"
#include "support/promise.hpp"
#include "tools/recording/driven_recording.hpp"
#include "view/recording/mcap_writer.hpp"
#include "view/recording/replay.hpp"

namespace slalom::fuzz {
namespace {

/// Throws Finding unless all estimates are finite and no deviation is negative.
void check_identification(const vehicle::Identification& found) {
  for (const vehicle::Identified& each : {found.steering_gain, found.steering_offset, found.delay,
                                          found.time_constant, found.wheelbase, found.understeer})
    testing::require(std::isfinite(each.value) && each.deviation >= 0,
                     "estimates are finite, deviations are not negative");
  testing::require(std::isfinite(found.speed_scale) && std::isfinite(found.residual) && found.explained <= 1,
                   "what is explained is finite");
}

/// A drive in curves, of a car that does what it is told.
std::string drive(int ticks) {
  std::ostringstream stream;
  view::mcap::Writer writer(stream, "slalom", 4096);
  const auto channel =
      writer.add_channel("/tick", "json", writer.add_schema("slalom.Tick", "jsonschema", "{}"));
  double x = 0, y = 0, yaw = 0;
  for (int i = 0; i < ticks; ++i) {
    const double time = 0.05 * i, steer = 0.3 * std::sin(2 * time);
    writer.add_message(channel, static_cast<std::uint64_t>(i) * 50000000,
                       Json{{"time", time},
                            {"odometry_x", x},
                            {"odometry_y", y},
                            {"odometry_yaw", yaw},
                            {"odometry_speed", 2.0},
                            {"command_steer", steer},
                            {"command_speed", 2.0}}
                           .dump());
    x += 0.1 * std::cos(yaw);
    y += 0.1 * std::sin(yaw);
    yaw += 0.1 * std::tan(steer) / 0.33;
  }
  writer.finish();
  return std::move(stream).str();
}

const Target driven_recording_target(
    "driven_recording", 1 << 15,
    []() -> Seeds {
      return {drive(230), drive(5)};
    },
    [](std::string_view bytes) {
      const auto samples = tools::read_drive(scratch_file("drive.mcap", bytes), tools::Wanted::scans).samples;
      try {
        check_identification(vehicle::identify(samples));
        return true;
      } catch (const std::invalid_argument&) {  // too few samples
        return false;
      }
    });

const Target mcap_target(
    "mcap", 1 << 15,
    []() -> Seeds {
      Seeds seeds;
      for (const int messages : {0, 3, 40}) {
        std::ostringstream stream;
        view::mcap::Writer writer(stream, "slalom", 256);
        const auto channel =
            writer.add_channel("/tick", "json", writer.add_schema("tick", "jsonschema", "{}"));
        writer.add_metadata("slalom", {{"seed", "4"}, {"course", "wren"}});
        for (int i = 0; i < messages; ++i)
          writer.add_message(channel, static_cast<std::uint64_t>(i) * 50000000,
                             "{\"tick\":" + std::to_string(i) + "}");
        view::ReplaySegments replay([&, number = 0](const std::string& segment) mutable {
          writer.add_attachment("replay/" + std::to_string(number++) + ".gz", "application/gzip", 7, segment);
        });
        replay.add_text("{}");
        replay.finish();
        replay.add_text("[]");
        replay.finish();
        writer.finish();
        seeds.push_back(std::move(stream).str());
      }
      seeds.push_back(seeds.back().substr(0, seeds.back().size() / 2));
      return seeds;
    },
    [](std::string_view bytes) {
      const std::string file = scratch_file("lap.mcap", bytes);
      std::vector<std::string> whole, kept;
      std::uint64_t lost = 0;
      const bool is_whole = is_valid([&] { whole = view::load_replay(file); });
      is_valid([&] { kept = view::load_replay(file, &lost); });
      require(!is_whole || kept == whole, "a recording that is whole opens the same where a cut one may");
      require(lost <= bytes.size(), "no more is lost than there was");
      return is_whole;
    });

}  // namespace
}  // namespace slalom::fuzz
