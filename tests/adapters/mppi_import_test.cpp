// The importer of parameter files for nav2's MPPI controller: the fate of each key, and what it refuses.
#include "logic/mppi_import.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "logic/path_follower.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::nodes {
namespace {

using testing::ScopedFolder;

/// A file with these lines in the section of the controller.
std::string with_lines(const ScopedFolder& folder, const std::string& lines) {
  return folder.write("params.yaml",
                      "controller_server:\n"
                      "  ros__parameters:\n"
                      "    controller_frequency: 20.0\n"
                      "    FollowPath:\n"
                      "      plugin: \"nav2_mppi_controller::MPPIController\"\n" +
                          lines);
}

ImportedSection import(const std::string& lines) {
  const ScopedFolder folder;
  const std::vector<ImportedSection> sections = import_mppi(with_lines(folder, lines));
  EXPECT_EQ(sections.size(), 1U);
  return sections.at(0);
}

const ImportedKey& find(const ImportedSection& section, const std::string& key) {
  for (const ImportedKey& each : section.keys)
    if (each.key == key) return each;
  throw std::runtime_error("no word of " + key);
}
std::string fate(const ImportedSection& section, const std::string& key) {
  return name(find(section, key).fate);
}
bool has_line(const ImportedSection& section, const std::string& line) {
  return ("\n" + section.yaml).find("\n" + line + "\n") != std::string::npos;
}

TEST(MppiImport, TakesWhatMeansTheSame) {
  const ImportedSection section = import(
      "      time_steps: 40\n"
      "      model_dt: 0.1\n"
      "      vx_max: 1\n"
      "      vx_min: -0.2\n"
      "      motion_model: \"Ackermann\"\n"
      "      visualize: True\n"
      "      AckermannConstraints:\n"
      "        min_turning_r: 0.4\n");
  EXPECT_EQ(section.name, "FollowPath");
  EXPECT_EQ(section.line, 4);
  for (const char* key : {"time_steps", "model_dt", "vx_max", "vx_min", "motion_model", "visualize",
                          "AckermannConstraints.min_turning_r"})
    EXPECT_EQ(fate(section, key), "taken") << key;
  EXPECT_EQ(find(section, "model_dt").line, 7);
  EXPECT_EQ(find(section, "AckermannConstraints.min_turning_r").line, 13);
  EXPECT_TRUE(has_line(section, "FollowPath:")) << section.yaml;
  EXPECT_TRUE(has_line(section, "  plugin: \"slalom_nav2::Controller\"")) << section.yaml;
  EXPECT_TRUE(has_line(section, "  time_steps: 40")) << section.yaml;
  EXPECT_TRUE(has_line(section, "  vx_max: 1.0")) << "ROS takes no integer for a number\n" << section.yaml;
  EXPECT_TRUE(has_line(section, "  vx_min: -0.2")) << section.yaml;
  EXPECT_TRUE(has_line(section, "  visualize: true")) << section.yaml;
  EXPECT_TRUE(has_line(section, "  AckermannConstraints:\n    min_turning_r: 0.4")) << section.yaml;
}

TEST(MppiImport, ChangesWhatHasAnotherScaleOrName) {
  const ImportedSection section = import(
      "      temperature: 0.6\n"
      "      GoalAngleCritic:\n"
      "        threshold_to_consider: 0.8\n"
      "        cost_weight: 3.0\n");
  EXPECT_EQ(fate(section, "temperature"), "changed");
  EXPECT_EQ(find(section, "temperature").result, "temperature: 0.06");
  EXPECT_FALSE(find(section, "temperature").why.empty());
  EXPECT_TRUE(has_line(section, "  temperature: 0.06")) << section.yaml;
  EXPECT_EQ(fate(section, "plugin"), "changed");
  EXPECT_EQ(fate(section, "GoalAngleCritic.threshold_to_consider"), "changed");
  EXPECT_EQ(find(section, "GoalAngleCritic.threshold_to_consider").result, "costs.goal_reach: 0.8");
  EXPECT_TRUE(has_line(section, "  costs:\n    goal_reach: 0.8")) << section.yaml;
  EXPECT_EQ(fate(section, "GoalAngleCritic.cost_weight"), "dropped");
}

TEST(MppiImport, TakesTheLeastAcceleration) {
  const ImportedSection least = import("      ax_max: 3.0\n      ax_min: -2.0\n      ay_max: 1.0\n");
  EXPECT_EQ(fate(least, "ax_min"), "changed");
  EXPECT_EQ(find(least, "ax_min").result, "ax_max: 2");
  EXPECT_EQ(fate(least, "ax_max"), "dropped");
  EXPECT_EQ(fate(least, "ay_max"), "dropped") << "the base cannot drive sideways";
  EXPECT_TRUE(has_line(least, "  ax_max: 2.0")) << least.yaml;
  const ImportedSection omni =
      import("      ax_max: 3.0\n      ay_max: 1.0\n      motion_model: Omni\n      ay_min: -4.0\n");
  EXPECT_TRUE(has_line(omni, "  ax_max: 1.0")) << omni.yaml;
  const ImportedSection alone = import("      ax_max: 3.0\n      ax_min: -3.0\n");
  EXPECT_EQ(fate(alone, "ax_max"), "taken");
}

TEST(MppiImport, NamesWhatItDropsAndWhatItDoesNotKnow) {
  const ImportedSection section = import(
      "      gamma: 0.015\n"
      "      critics: [\n"
      "        \"ConstraintCritic\", \"CostCritic\"]\n"
      "      CostCritic:\n"
      "        cost_weight: 3.81\n"
      "      vx_maxx: 0.5\n"
      "      favourite_colour: blue\n");
  EXPECT_EQ(fate(section, "gamma"), "dropped");
  EXPECT_NE(find(section, "gamma").why, "");
  EXPECT_EQ(fate(section, "critics"), "dropped");
  EXPECT_EQ(find(section, "critics").value, "a list");
  EXPECT_EQ(fate(section, "CostCritic.cost_weight"), "dropped");
  EXPECT_EQ(fate(section, "vx_maxx"), "unknown");
  EXPECT_NE(find(section, "vx_maxx").why.find("'vx_max'"), std::string::npos) << find(section, "vx_maxx").why;
  EXPECT_EQ(fate(section, "favourite_colour"), "unknown");
  EXPECT_EQ(section.yaml.find("gamma"), std::string::npos);
  EXPECT_EQ(section.keys.size(), 6U) << "with that of the plugin";
}

TEST(MppiImport, FindsEverySectionUnderAnyNamespace) {
  const ScopedFolder folder;
  const std::string section = "{plugin: \"nav2_mppi_controller::MPPIController\", vx_max: 0.4}\n";
  const auto found = import_mppi(folder.write(
      "params.yaml",
      "/robot:\n  controller_server:\n    ros__parameters:\n      Fast: " + section +
          "      Other: {plugin: \"dwb_core::DWBLocalPlanner\", vx_max: 0.4}\n      Slow: " + section));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "Fast");
  EXPECT_EQ(found[1].name, "Slow");
}

TEST(MppiImport, RefusesBadInputWithFileLineKeyAndRule) {
  const ScopedFolder folder;
  const auto refuses = [&](const std::string& lines, const std::vector<const char*>& words) {
    expect_error_with<std::runtime_error>(words, [&] { import_mppi(with_lines(folder, lines)); });
  };
  refuses("      time_steps: fast\n",
          {"params.yaml:6:", "FollowPath.time_steps", "'fast' must be an integer"});
  refuses("      model_dt: 0.05\n      batch_size: 0\n",
          {"params.yaml:7:", "FollowPath.batch_size", "'0' must be in [1, 4194304]"});
  refuses("      vx_min: 0.3\n", {"params.yaml:6:", "FollowPath.vx_min", "must be in [-20, 0]"});
  refuses("      motion_model: Boat\n", {"params.yaml:6:", "motion_model", "must be one of DiffDrive"});
  refuses("      temperature: warm\n", {"params.yaml:6:", "temperature", "'warm' must be a number"});
  refuses("      temperature: -1\n", {"params.yaml:6:", "temperature", "must be at least 0"});
  refuses("      ax_min: [1]\n", {"params.yaml:6:", "ax_min", "must be one value"});
  refuses("      vx_max: 0.4\n      vx_max: 0.5\n", {"params.yaml:7:", "vx_max", "duplicate key"});
  refuses("      AckermannConstraints:\n        min_turning_r: -1\n",
          {"params.yaml:7:", "AckermannConstraints.min_turning_r", "must be in"});
  refuses("      vx_max: [1\n", {"params.yaml"});
  expect_error_with<std::runtime_error>({"params.yaml", "nav2_mppi_controller::MPPIController"}, [&] {
    import_mppi(folder.write("params.yaml", "controller_server:\n  ros__parameters: {a: 1}\n"));
  });
  expect_error_with<std::runtime_error>({"none.yaml"}, [&] { import_mppi(folder.path() / "none.yaml"); });
}

}  // namespace
}  // namespace slalom::nodes
