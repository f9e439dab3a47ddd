// The pictures of `slalom navigate`.
#include "tools/commands/navigate_picture.hpp"

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace slalom::tools {
namespace {

/// The picture of a drive straight ahead for 5 s.
class NavigatePicture : public testing::TemporaryFolder {
 protected:
  std::string picture_of(const std::vector<std::vector<maps::Point>>& people) const {
    RoomSeries series{&scenario_, "svg_mppi", {{}}};
    evaluation::RoomDrive& drive = series.drives[0];
    for (int i = 0; i < periods; ++i) drive.trace.push_back({1 + 0.02 * i, 3, 0});
    drive.people = people;
    draw({series}, scenario_, folder_);
    return testing::content(folder_ / (std::string(scenario_.name) + ".png"));
  }

  static constexpr int periods = 100;  ///< of 0.05 s
  const evaluation::RoomScenario& scenario_ = evaluation::room_scenario("crossing-walker");
};

TEST_F(NavigatePicture, ShowsPeopleWhereTheyWereEveryThreeSeconds) {
  const std::vector<maps::Point> stands(periods, maps::Point{4.5, 5});
  std::vector<maps::Point> steps = stands;
  for (std::size_t i = 59; i <= 61; ++i) steps[i] = {4.5, 4};
  std::vector<maps::Point> steps_late = stands;
  for (std::size_t i = 62; i <= 64; ++i) steps_late[i] = {4.5, 4};
  const std::string nobody = picture_of({}), standing = picture_of({stands});
  EXPECT_NE(nobody, standing);
  EXPECT_EQ(standing, picture_of({stands})) << "the same drive gives the same picture";
  EXPECT_NE(picture_of({steps}), picture_of({steps_late})) << "the same way, but elsewhere after 3 s";
}

}  // namespace
}  // namespace slalom::tools
