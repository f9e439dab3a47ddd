// Every reader refuses a pipe: to open it would wait for a writer, for ever.
#include <sys/stat.h>
#include <unistd.h>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/evaluation/lap_log.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "support/temporary_folder.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/recording/driven_recording.hpp"
#include "vehicle/course_folder.hpp"
#include "view/recording/replay.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;

struct FileReader {
  const char* name;
  const char* file;  ///< name of the pipe
  std::function<void(const fs::path& pipe)> read;
  const char* says = "regular file";
};

void PrintTo(const FileReader& reader, std::ostream* out) {
  *out << reader.name;
}

const std::vector<evaluation::Experiment> no_experiments;

/// Loads a course that is sound up to the pipe in its folder.
void read_course(const fs::path& pipe) {
  const testing::CourseFolder sound;
  for (const char* file : {"map.yaml", "map.png", "raceline.csv"})
    if (pipe.filename() != file) fs::copy_file(sound.path() / file, pipe.parent_path() / file);
  vehicle::load_course(pipe.parent_path());
}

const FileReader readers[] = {
    {"MapImage", "map.png", [](const fs::path& pipe) { maps::load_image(pipe); }},
    {"MapYaml", "map.yaml", [](const fs::path& pipe) { maps::load_ros_map(pipe); }},
    {"CourseYaml", "course.yaml", read_course},
    {"CourseMap", "map.png", read_course},
    {"ObstaclePath", "opp_ref_path.csv", read_course},
    // A course is searched for its waypoints among regular files.
    {"Waypoints", "raceline.csv", read_course, "waypoint file"},
    {"Configuration", "car.yaml", [](const fs::path& pipe) { vehicle::load_configuration(pipe); }},
    {"CentreLine", "line.csv", [](const fs::path& pipe) { vehicle::read_centre_line(pipe); }},
    {"Network", "car.npz", [](const fs::path& pipe) { load_mlp(pipe); }},
    {"Laps", "laps.csv", [](const fs::path& pipe) { evaluation::read_rows(pipe, no_experiments, false, 0); }},
    {"Journal", "laps.journal.csv",
     [](const fs::path& pipe) { evaluation::read_rows(pipe, no_experiments, true, 0); }},
    {"Settings", "settings.json", [](const fs::path& pipe) { load_evaluation(pipe.parent_path()); }},
    {"LapLog", "log.csv", [](const fs::path& pipe) { evaluation::read_lap_log(pipe); }},
    {"DrivenSamples", "lap.mcap", [](const fs::path& pipe) { read_drive(pipe.string()); }},
    {"Mcap", "lap.mcap", [](const fs::path& pipe) { view::load_replay(pipe.string()); }}};

class RegularFiles : public ::testing::TestWithParam<FileReader> {
 protected:
  void TearDown() override { ::alarm(0); }
  const testing::ScopedFolder scoped_;
};

TEST_P(RegularFiles, APipeIsRefused) {
  const fs::path pipe = scoped_.path() / GetParam().file;
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  ::alarm(60);  // a reader that waits ends the test program
  try {
    GetParam().read(pipe);
    ADD_FAILURE() << "was read";
  } catch (const IoError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find(scoped_.path().string()), std::string::npos) << said;
    EXPECT_NE(said.find(GetParam().says), std::string::npos) << said;
  }
}

INSTANTIATE_TEST_SUITE_P(Reader, RegularFiles, ::testing::ValuesIn(readers),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace slalom::tools
