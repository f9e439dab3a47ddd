// Charts of rows: names stay left of the panels.
#include "tools/drawing/row_chart.hpp"

#include "slalom/maps/image.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::tools {
namespace {

class RowChartPicture : public testing::TemporaryFolder {};

TEST_F(RowChartPicture, LongNamesDoNotReachThePanels) {
  RowChart chart;
  chart.names = {"svg_mppi",
                 "svg_mppi, svg_mppi.gradient_variance=0.01,4, svg_mppi.restart_standard_deviation=0.3",
                 "svg_mppi, svg_mppi.sample_around=solution, vehicle.terminal_distance_weight=200, "
                 "planner.profile_friction=0.7, world.range_noise=0.02"};
  Panel panel{.title = "cost", .axis = "cost", .kind = Panel::Kind::bars, .ours = {}, .theirs = {}};
  panel.ours.assign(3, {.values = {}, .span = Span{2, 1.5, 3}});
  chart.panels = {panel};
  save(draw_chart(chart), folder_ / "chart.png", 1);
  const maps::GreyImage image = maps::load_image(folder_ / "chart.png");
  constexpr int first_row = 44 + 62, rows_end = first_row + 3 * 42, names_end = 18 + 250 - 12;
  int ink = 0, beside = 0;
  for (int y = first_row; y < rows_end; ++y)
    for (int x = 0; x < 18 + 250 - 4; ++x)
      if (image.grey[static_cast<std::size_t>(y * image.width + x)] < 200) ++(x < names_end ? ink : beside);
  EXPECT_GT(ink, 1000);
  EXPECT_EQ(beside, 0);
}

}  // namespace
}  // namespace slalom::tools
