// The parameters of the controller for nav2: their names, and what they refuse.
#include <gtest/gtest.h>

#include <algorithm>

#include "logic/path_follower.hpp"
#include "support/thrown_words.hpp"

namespace slalom::nodes {
namespace {

TEST(FollowerOptions, HaveTheNamesOfMppiThatMeanTheSame) {
  const PathFollower follower;
  const std::vector<NamedOption> options = follower.options();
  const auto find = [&](const std::string& name) {
    const auto found = std::find_if(options.begin(), options.end(),
                                    [&](const NamedOption& each) { return each.name == name; });
    return found == options.end() ? nullptr : &*found;
  };
  for (const char* name : {"temperature", "ax_max", "look_ahead", "patience", "costs.progress",
                           "svg_mppi.guides", "svg_mppi.seed"})
    EXPECT_NE(find(name), nullptr) << name;
  for (const NamedOption& each : options) EXPECT_STRNE(each.entry.declaration.help, "") << each.name;
  EXPECT_EQ(to_text(find("vx_max")->entry.value), "0.5");
  EXPECT_EQ(range_rule(find("vx_max")->entry.declaration), "must be in [0.01, 20]");
  EXPECT_EQ(to_text(find("time_steps")->entry.value), "56");
  EXPECT_EQ(find("motion_model")->entry.choices,
            (std::vector<std::string>{"DiffDrive", "Omni", "Ackermann"}));
  for (const char* name : {"base", "max_forward", "max_reverse", "horizon", "svg_mppi.horizon",
                           "svg_mppi.variance", "svg_mppi.input_max"})
    EXPECT_EQ(find(name), nullptr) << name << " follows from others or has another name";
  std::vector<std::string> names;
  for (const NamedOption& each : options) names.push_back(each.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "two of the same name";
}

TEST(FollowerOptions, AreRefusedWithTheirRuleAndThenNothingChanges) {
  PathFollower follower;
  const auto why = [&](const Changes& changes) {
    return message_of<std::exception>([&] { follower.change(changes); });
  };
  const auto value = [&](const std::string& name) {
    for (const NamedOption& each : follower.options())
      if (each.name == name) return to_text(each.entry.value);
    return std::string();
  };
  EXPECT_EQ(why({{"time_steps", "30"}, {"vx_max", "-3"}}), "vx_max: '-3' must be in [0.01, 20]");
  EXPECT_EQ(value("time_steps"), "56");
  EXPECT_EQ(why({{"motion_model", "boat"}}),
            "motion_model: 'boat' must be one of DiffDrive, Omni, Ackermann");
  EXPECT_EQ(why({{"vx_min", "0.1"}}), "vx_min: '0.1' must be in [-20, 0]");
  EXPECT_EQ(why({{"time_step", "30"}}), "time_step: unknown option, did you mean 'time_steps'?");
  EXPECT_NE(why({{"costs.none", "1"}}), "accepted");
  EXPECT_EQ(why({{"time_steps", "30"}, {"costs.path", "3"}, {"svg_mppi.guides", "2"}}), "accepted");
  EXPECT_EQ(value("time_steps"), "30");
  EXPECT_EQ(value("costs.path"), "3");
  EXPECT_THROW(PathFollower("none"), std::exception);
}

}  // namespace
}  // namespace slalom::nodes
