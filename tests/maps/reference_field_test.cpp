#include "slalom/maps/reference_field.hpp"

#include <gtest/gtest.h>

#include <random>

#include "slalom/maps/local_cost_map.hpp"

namespace slalom::maps::reference_field_test {
namespace {

std::vector<ReferencePoint> circle(int count, double radius) {
  std::vector<ReferencePoint> path;
  for (int i = 0; i < count; ++i) {
    const double t = 2 * M_PI * i / count;
    path.push_back({radius * std::cos(t), radius * std::sin(t), wrap_angle(t + M_PI / 2), 2 + std::cos(t)});
  }
  return path;
}

/// Every cell against all points of the window.
void expect_nearest(const ReferenceField& field, const std::vector<ReferencePoint>& path, int half = 1000) {
  const GridGeometry& geometry = field.geometry();
  for (int row = std::max(0, geometry.rows / 2 - half);
       row < std::min(geometry.rows, geometry.rows / 2 + half); ++row) {
    for (int column = std::max(0, geometry.columns / 2 - half);
         column < std::min(geometry.columns, geometry.columns / 2 + half); ++column) {
      const double x = geometry.cell_x(row), y = geometry.cell_y(column);
      double best = 1e300;
      for (const int i : field.window()) {
        const ReferencePoint& point = path[i];
        best = std::min(best, std::hypot(point.x - x, point.y - y));
      }
      const float* cell = field.cells().at(row, column);
      ASSERT_NEAR(cell[0], best, 1e-5) << row << ' ' << column;
      // The point whose speed it has is as near as the nearest.
      bool found = false;
      for (const int i : field.window()) {
        const ReferencePoint& point = path[i];
        found |= static_cast<float>(point.speed) == cell[2] && static_cast<float>(point.yaw) == cell[1] &&
                 std::hypot(point.x - x, point.y - y) <= best + 1e-9;
      }
      ASSERT_TRUE(found) << row << ' ' << column;
    }
  }
}

/// The cells beside a circle, of whose points `count` are in the window, are those of the line itself.
void expect_line(const ReferenceField& field, int count, double radius) {
  const GridGeometry& geometry = field.geometry();
  const double turn = M_PI / count, sagitta = radius * (1 - std::cos(turn));
  int cells = 0;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const double x = geometry.cell_x(row), y = geometry.cell_y(column);
      const double from_centre = std::hypot(x, y), angle = std::atan2(y, x);
      if (std::abs(from_centre - radius) > 1 || std::abs(angle) > 1) continue;  // away from the window's ends
      const float* cell = field.cells().at(row, column);
      ASSERT_NEAR(cell[0], std::abs(from_centre - radius), 3 * sagitta) << x << ' ' << y;
      ASSERT_NEAR(wrap_angle(cell[1] - angle - M_PI / 2), 0, 1e-3) << x << ' ' << y;
      ASSERT_NEAR(cell[2], 2 + std::cos(angle), turn * turn) << x << ' ' << y;
      ++cells;
    }
  }
  EXPECT_GT(cells, 1500);
}

TEST(ReferenceField, EqualsBruteForceOnRandomPaths) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-6, 6);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<ReferencePoint> path;
    // Every third path lies on a lattice: many points share a row or a column, some coincide.
    const auto draw = [&] { return trial % 3 == 0 ? std::round(uniform(random)) : uniform(random); };
    for (int i = 0; i < 60; ++i) path.push_back({draw(), draw(), 0.01 * i, 0.1 * i});
    ReferenceField field(
        path,
        {.length_x = 8, .length_y = 6, .resolution = 0.25, .points = 30, .spacing = 0, .points_behind = 9});
    ASSERT_TRUE(field.update({draw(), draw()}));
    EXPECT_EQ(field.window().size(), 39u);
    expect_nearest(field, path);
  }
}

TEST(ReferenceField, TheWindowKeepsItsSpacingAndWraps) {
  const auto path = circle(1000, 3);  // 1.9 cm apart
  ReferenceField field(path, {.points = 40, .spacing = 0.1, .points_behind = 12});
  ASSERT_TRUE(field.update({3.2, -0.05}));
  ASSERT_EQ(field.window().size(), 52u);
  EXPECT_EQ(field.window()[12], field.nearest());
  EXPECT_EQ(field.nearest(), 998);  // the point at -0.0126 rad; the robot is at -0.0156
  for (std::size_t k = 1; k < 52; ++k) {
    const int step = (field.window()[k] - field.window()[k - 1] + 1000) % 1000;
    EXPECT_EQ(step, 6) << k;
  }
}

TEST(ReferenceField, AShortPathAppearsOnce) {
  const auto path = circle(7, 1);
  ReferenceField field(path, published_reference_field());
  EXPECT_EQ(field.window().size(), 7u);
  expect_nearest(field, path);
}

TEST(ReferenceField, APartialUpdateEqualsTheWholeMap) {
  const auto path = circle(600, 5);
  ReferenceField whole(path), part(path);
  for (const double reach : {0.0, 1.7, 40.0}) {
    ASSERT_TRUE(whole.update({0.3, 4.9}));
    ASSERT_TRUE(part.update({0.3, 4.9}, reach));
    const double most = std::min(reach, 9.0);
    for (double x = 0.3 - most; x <= 0.3 + most; x += 0.033)
      for (double y = 4.9 - most; y <= 4.9 + most; y += 0.033) {
        ASSERT_EQ(part.at(x, y).distance, whole.at(x, y).distance) << x << ' ' << y;
        ASSERT_EQ(part.at(x, y).speed, whole.at(x, y).speed);
      }
    // Something else elsewhere, so that nothing is right by chance.
    ASSERT_TRUE(part.update({-4, 0}));
  }
}

TEST(ReferenceField, WithSecondsItReachesAsFarAsItsSpeedsLead) {
  auto path = circle(600, 5);
  for (auto& point : path) point.speed = 4;
  ReferenceField field(path);
  ASSERT_TRUE(field.update({5.1, 0}));
  ASSERT_TRUE(field.update({0, 4.9}, 1.0, 0.5));
  EXPECT_EQ(field.reach(), 3.0);
  expect_nearest(field, path, 30);
  ASSERT_TRUE(field.update({0, 4.9}, 5.0, 0.5));
  EXPECT_EQ(field.reach(), 5.0);
}

TEST(ReferenceField, KnowsTheProgressBesideACurve) {
  const double radius = 5;
  const auto path = circle(600, radius);
  ReferenceField field(path);
  ASSERT_TRUE(field.update({5, 0}));
  EXPECT_EQ(field.at(4, 0.5).outside, 0);
  field.set_curvatures(std::vector<double>(599, 1 / radius), true);  // has no effect: one is missing
  ASSERT_TRUE(field.update({5, 0}));
  EXPECT_EQ(field.at(4, 0.5).outside, 0);
  field.set_curvatures(std::vector<double>(600, 1 / radius), true);
  ASSERT_TRUE(field.update({5, 0}));
  const GridGeometry& geometry = field.geometry();
  for (const double x : {2.0, 4.0, 5.0, 6.5, 9.0}) {
    const int row = geometry.row(x), column = geometry.column(0.5);
    const double from_centre = std::hypot(geometry.cell_x(row), geometry.cell_y(column));
    // On a circle of this radius a metre is radius / from_centre metres of the path.
    EXPECT_NEAR(field.at(x, 0.5).outside, -radius / from_centre, 1e-3) << x;
  }
  EXPECT_NEAR(field.at(0.05, 0.05).outside, -4, 1e-6) << "limited near the centre of the curve";
  ASSERT_TRUE(field.set_path(path));
  ASSERT_TRUE(field.update({5, 0}));
  EXPECT_EQ(field.at(4, 0.5).outside, 0) << "a new path has no curvatures";
}

TEST(ReferenceField, WithCurvaturesNoPlaceOfTheLineIsLeftOutWhereTheWindowSkipsPoints) {
  constexpr double radius = 5;
  constexpr int count = 600;  // 0.052 m apart, in the window 0.157 m
  ReferenceField field(circle(count, radius), {.spacing = 0.15, .points_behind = 40});
  field.set_curvatures(std::vector<double>(count, 1 / radius), true);
  ASSERT_TRUE(field.update({radius, 0}));
  ASSERT_EQ(field.window()[1], field.window()[0] + 3);
  expect_line(field, count / 3, radius);
}

TEST(ReferenceField, WithCurvaturesAnOpenPathHasEnds) {
  std::vector<ReferencePoint> path;
  for (int i = 0; i <= 20; ++i) path.push_back({0.25 * i, 0, 0, 3 + 0.1 * i});
  ReferenceField field(path);
  field.set_curvatures(std::vector<double>(path.size(), 0), false);
  ASSERT_TRUE(field.update({3, 0}));
  const GridGeometry& geometry = field.geometry();
  const auto expect_cell = [&](double x, double y, double arc) {
    const int row = geometry.row(x), column = geometry.column(y);
    const float* cell = field.cells().at(row, column);
    EXPECT_NEAR(cell[0], std::hypot(geometry.cell_x(row) - arc, geometry.cell_y(column)), 1e-5) << x;
    EXPECT_NEAR(cell[2], 3 + 0.4 * arc, 1e-5) << x;
  };
  expect_cell(-1, 0.5, 0);
  expect_cell(6, 0.5, 5);
  expect_cell(2.13, -0.5, geometry.cell_x(geometry.row(2.13)));
}

TEST(ReferenceField, OutsideAndBadPositions) {
  const auto path = circle(600, 5);
  ReferenceField field(path, {.outside = {.distance = 20, .yaw = 2, .speed = 0}});
  ASSERT_TRUE(field.update({5, 0}));
  for (const auto& [x, y] :
       {Point{15.01, 0}, Point{-5.01, 0}, Point{5, 10.01}, Point{NAN, 0}, Point{0, INFINITY}}) {
    EXPECT_EQ(field.at(x, y).distance, 20);
    EXPECT_EQ(field.at(x, y).yaw, 2);
    EXPECT_EQ(field.at(x, y).speed, 0);
  }
  const ReferenceCell before = field.at(5, 0.3);
  EXPECT_FALSE(field.update({NAN, 0}));
  EXPECT_FALSE(field.update({0, INFINITY}));
  EXPECT_EQ(field.at(5, 0.3).yaw, before.yaw);
  EXPECT_TRUE(field.update({1e5, 1e5}));  // far from the path, all the same exact
  EXPECT_NEAR(field.at(1e5, 1e5).distance, 1e5 * std::sqrt(2.0) - 5, 0.2);
}

TEST(ReferenceField, TheViewLooksUpTheSameCells) {
  const auto path = circle(600, 5);
  ReferenceField field(path);
  ASSERT_TRUE(field.update({4.9, 0.7}));
  const GridView<4> view = field.view();
  for (double x = -5.4; x < 15.2; x += 0.0931) {
    for (double y = -9.6; y < 11; y += 0.0777) {
      const ReferenceCell cell = field.at(x, y);
      const auto values = look_up(view, x, y);
      ASSERT_EQ(values.a, cell.distance) << x << ' ' << y;
      ASSERT_EQ(values.b, cell.yaw);
      ASSERT_EQ(values.c, cell.speed);
    }
  }
}

/// Drives round an eight whose parts cross at 97 degrees, 0.3 m beside it and turned to the other part.
TEST(ReferenceField, KeepsToItsPartWhereThePathCrossesItself) {
  std::vector<ReferencePoint> path;
  for (int i = 0; i < 400; ++i) {
    const double t = 2 * M_PI * i / 400;
    path.push_back(
        {10 * std::sin(t), 4.4 * std::sin(2 * t), std::atan2(8.8 * std::cos(2 * t), 10 * std::cos(t)), 1});
  }
  ReferenceField driven(path);
  for (int i = 0; i < 400; ++i)
    for (const double side : {0.3, -0.3}) {
      const ReferencePoint& at = path[static_cast<std::size_t>(i)];
      const Point beside = transform({at.x, at.y, at.yaw}, {0, side});
      ReferenceField placed(path);
      for (ReferenceField* field : {&driven, &placed}) {
        ASSERT_TRUE(field->update({beside.x, beside.y, at.yaw + side / 0.75}, 0.1));
        EXPECT_LE(std::abs(std::remainder(field->nearest() - i, 400)), 3) << i << ' ' << side;
      }
    }
  // Facing along the other part, within 90 degrees of its own, it is still on its own.
  ASSERT_TRUE(driven.update({0, 0, path[200].yaw}));
  ASSERT_TRUE(driven.update({0, 0, path[0].yaw + 0.3}));
  EXPECT_EQ(driven.nearest(), 200);
  driven.reset();
  ASSERT_TRUE(driven.update({0, 0, path[0].yaw + 0.3}));
  EXPECT_EQ(driven.nearest(), 0);
}

TEST(ReferenceField, RejectsInvalidPaths) {
  EXPECT_THROW(ReferenceField(circle(2, 1)), std::invalid_argument);
  EXPECT_THROW(ReferenceField({}), std::invalid_argument);
  for (const double bad : {double{NAN}, double{INFINITY}, 1e9}) {
    auto path = circle(10, 1);
    path[4].x = bad;
    EXPECT_THROW(ReferenceField{path}, std::invalid_argument);
  }
  EXPECT_THROW(ReferenceField(circle(100, 1e-3)), std::invalid_argument);
  EXPECT_THROW(ReferenceField(circle(70000, 1)), std::invalid_argument);
  auto path = circle(10, 1);
  path[9].speed = -1;
  EXPECT_THROW(ReferenceField{path}, std::invalid_argument);
  path[9].speed = NAN;
  EXPECT_THROW(ReferenceField{path}, std::invalid_argument);
}

}  // namespace
}  // namespace slalom::maps::reference_field_test
