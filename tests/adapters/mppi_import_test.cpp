// The importer of parameter files for nav2's MPPI controller: the fate of each key, and what it refuses.
#include "logic/mppi_import.hpp"

#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::nodes::mppi_import_test {
namespace {

/// Imports a file with these lines in the section of the controller, from line 6 on.
MppiImport import(const std::string& lines) {
  const testing::ScopedFolder folder;
  return import_mppi(folder.write("params.yaml",
                                  "controller_server:\n"
                                  "  ros__parameters:\n"
                                  "    controller_frequency: 20.0\n"
                                  "    FollowPath:\n"
                                  "      plugin: \"nav2_mppi_controller::MPPIController\"\n" +
                                      lines));
}

void expect_words(const std::string& text, const std::vector<const char*>& words) {
  for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in\n" << text;
}

TEST(MppiImport, TakesWhatMeansTheSame) {
  const MppiImport imported = import(R"(
      time_steps: 40
      model_dt: 0.1
      batch_size: 500
      vx_max: 1
      vx_min: -0.2
      vy_max: 0.3
      wz_max: 1.5
      az_max: 3.0
      vx_std: 0.2
      vy_std: 0.1
      wz_std: 0.3
      motion_model: "Ackermann"
      open_loop: False
      visualize: True
      retry_attempt_limit: 3
      transform_tolerance: 0.2
      AckermannConstraints:
        min_turning_r: 0.4
)");
  expect_words(imported.report,
               {"params.yaml:7: FollowPath.time_steps: 40: taken\n",
                "params.yaml:18: FollowPath.motion_model: Ackermann: taken\n",
                "params.yaml:24: FollowPath.AckermannConstraints.min_turning_r: 0.4: taken\n"});
  std::size_t taken = 0;
  for (std::size_t at = 0; (at = imported.report.find(": taken\n", at)) != std::string::npos; ++at) ++taken;
  EXPECT_EQ(taken, 17U) << imported.report;
  expect_words(imported.yaml, {"\nFollowPath:\n  plugin: \"slalom_nav2::Controller\"\n",
                               "\n  time_steps: 40\n", "\n  vx_min: -0.2\n", "\n  visualize: true\n",
                               "\n  AckermannConstraints:\n    min_turning_r: 0.4\n"});
  expect_words(imported.yaml, {"\n  vx_max: 1.0\n"});  // ROS takes no integer for a number
}

TEST(MppiImport, ChangesWhatHasAnotherScaleOrName) {
  const MppiImport imported = import(R"(
      temperature: 0.6
      GoalAngleCritic:
        threshold_to_consider: 0.8
        cost_weight: 3.0
)");
  expect_words(
      imported.report,
      {"FollowPath.plugin: nav2_mppi_controller::MPPIController: changed to plugin: slalom_nav2",
       "FollowPath.temperature: 0.6: changed to temperature: 0.2 (costs have another scale;",
       "threshold_to_consider: 0.8: changed to costs.goal_reach: 0.8 (the name here)",
       "GoalAngleCritic.cost_weight: 3.0: dropped (the cost has another scale: costs.goal_heading)"});
  expect_words(imported.yaml, {"\n  temperature: 0.2\n", "\n  costs:\n    goal_reach: 0.8\n"});
}

TEST(MppiImport, TakesMotionModelsThatArePlugins) {
  const MppiImport imported = import(R"(
      motion_model: "car"
      car:
        plugin: "mppi::AckermannMotionModel"
        min_turning_r: 0.6
      model_delay_vx: 0.2
      model_delay_wz: 0.3
      TrajectoryValidator:
        plugin: "mppi::DefaultOptimalTrajectoryValidator"
      publish_optimal_trajectory: true
)");
  expect_words(imported.yaml, {"\n  motion_model: Ackermann\n", "\n    min_turning_r: 0.6\n",
                               "\n  delay_forward: 0.2\n", "\n  delay_turn: 0.3\n"});
  expect_words(imported.report,
               {"motion_model: car: changed to motion_model: Ackermann (the name here)",
                "car.plugin: mppi::AckermannMotionModel: taken as motion_model",
                "TrajectoryValidator.plugin: mppi::DefaultOptimalTrajectoryValidator: dropped"});
  EXPECT_EQ(imported.report.find("unknown"), std::string::npos) << imported.report;
  expect_words(import("      motion_model: diff_drive\n").yaml, {"\n  motion_model: DiffDrive\n"});
  expect_words(import("      motion_model: omni\n      omni: {plugin: \"mppi::OmniMotionModel\"}\n"
                      "      ax_max: 3.0\n      ay_max: 1.0\n")
                   .yaml,
               {"\n  motion_model: Omni\n", "\n  ax_max: 3.0\n", "\n  ay_max: 1.0\n"});
  expect_error_with<std::runtime_error>({"params.yaml:7:", "m.plugin", "must be a motion model of mppi"}, [] {
    import("      motion_model: m\n      m: {plugin: \"my::Model\"}\n");
  });
}

TEST(MppiImport, KeepsARobotThatDoesNotTurn) {
  for (const char* lines : {"      wz_std: 0.0\n      wz_max: 1.9\n", "      wz_max: 1.9\n      wz_std: 0\n",
                            "      wz_max: 0.0\n", "      wz_max: 0\n      wz_std: 0.4\n"}) {
    const MppiImport imported = import(lines);
    expect_words(imported.yaml, {"\n  wz_max: 0.0\n"});
    EXPECT_EQ(imported.yaml.find("wz_std: 0.0"), std::string::npos) << imported.yaml;
  }
}

TEST(MppiImport, TakesTheLimitsOfEachAxisAndDeadBands) {
  const MppiImport imported = import(R"(
      motion_model: Omni
      ax_max: 3.0
      ax_min: -2.5
      ay_max: 1
      ay_min: -1.5
      VelocityDeadbandCritic:
        deadband_velocities: [0.05, 0.06, 0.1]
        cost_weight: 35.0
)");
  expect_words(imported.report, {"ax_max: 3.0: taken", "ay_max: 1: taken",
                                 "ax_min: -2.5: changed to max_deceleration: 2.5 (the name here)",
                                 "deadband_velocities: a list: changed to dead_band_forward, dead_band_sid",
                                 "VelocityDeadbandCritic.cost_weight: 35.0: dropped"});
  expect_words(imported.yaml, {"\n  ax_max: 3.0\n", "\n  max_deceleration: 2.5\n", "\n  ay_max: 1.0\n",
                               "\n  max_sideways_deceleration: 1.5\n", "\n  dead_band_forward: 0.05\n",
                               "\n  dead_band_sideways: 0.06\n", "\n  dead_band_turn: 0.1\n"});
  expect_error_with<std::runtime_error>({"params.yaml:6:", "deadband_velocities", "a list of 3 numbers"}, [] {
    import("      VelocityDeadbandCritic: {deadband_velocities: [0.1]}\n");
  });
}

TEST(MppiImport, NamesWhatItDropsAndWhatItDoesNotKnow) {
  const MppiImport imported = import(R"(
      gamma: 0.015
      critics: [
        "ConstraintCritic", "CostCritic"]
      CostCritic:
        cost_weight: 3.81
      vx_maxx: 0.5
      favourite_colour: blue
)");
  expect_words(imported.report,
               {"gamma: 0.015: dropped (the weights have no control cost", "critics: a list: dropped (",
                "CostCritic.cost_weight: 3.81: dropped (",
                "vx_maxx: 0.5: unknown (no parameter of nav2's MPPI controller, did you mean 'vx_max'?)\n",
                "favourite_colour: blue: unknown (no parameter of nav2's MPPI controller)\n"});
  EXPECT_EQ(imported.yaml.find("gamma"), std::string::npos);
}

TEST(MppiImport, FindsEverySectionUnderAnyNamespace) {
  const testing::ScopedFolder folder;
  const std::string section = "{plugin: \"nav2_mppi_controller::MPPIController\", vx_max: 0.4}\n";
  const MppiImport found = import_mppi(folder.write(
      "params.yaml",
      "/robot:\n  controller_server:\n    ros__parameters:\n      Fast: " + section +
          "      Other: {plugin: \"dwb_core::DWBLocalPlanner\", vx_max: 0.4}\n      Slow: " + section));
  expect_words(found.yaml, {"\nFast:\n", "\nSlow:\n"});
  EXPECT_EQ(found.yaml.find("Other"), std::string::npos);
}

TEST(MppiImport, RefusesBadInputWithFileLineKeyAndRule) {
  const auto refuses = [](const std::string& lines, const std::vector<const char*>& words) {
    expect_error_with<std::runtime_error>(words, [&] { import(lines); });
  };
  refuses("      time_steps: fast\n",
          {"params.yaml:6:", "FollowPath.time_steps", "'fast' must be an integer"});
  refuses("      model_dt: 0.05\n      batch_size: 0\n",
          {"params.yaml:7:", "FollowPath.batch_size", "'0' must be in [1, 4194304]"});
  refuses("      motion_model: Boat\n", {"params.yaml:6:", "motion_model", "must be one of DiffDrive"});
  refuses("      temperature: warm\n", {"params.yaml:6:", "temperature", "'warm' must be a number"});
  refuses("      temperature: -1\n", {"params.yaml:6:", "temperature", "must be at least 0"});
  refuses("      ax_min: [1]\n", {"params.yaml:6:", "ax_min", "must be one value"});
  refuses("      vx_max: 0.4\n      vx_max: 0.5\n", {"params.yaml:7:", "vx_max", "duplicate key"});
  refuses("      AckermannConstraints:\n        min_turning_r: -1\n",
          {"params.yaml:7:", "AckermannConstraints.min_turning_r", "must be in"});
  refuses("      vx_max: [1\n", {"params.yaml"});
  const testing::ScopedFolder folder;
  expect_error_with<std::runtime_error>({"params.yaml", "nav2_mppi_controller::MPPIController"}, [&] {
    import_mppi(folder.write("params.yaml", "controller_server:\n  ros__parameters: {a: 1}\n"));
  });
  expect_error_with<std::runtime_error>({"none.yaml"}, [&] { import_mppi(folder.path() / "none.yaml"); });
}

}  // namespace
}  // namespace slalom::nodes::mppi_import_test
