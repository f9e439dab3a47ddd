#include <gtest/gtest.h>

#include <string>

#include "models.hpp"
#include "slalom/core/error.hpp"
#include "slalom/mujoco/evaluator.hpp"
#include "support/thrown_words.hpp"

namespace slalom::mujoco::testing {
namespace {

TEST_F(ModelTest, AFileThatIsMissingOrNoModelIsAnErrorWithItsNameAndMuJoCosMessage) {
  const std::string missing = (folder_ / "missing.xml").string();
  EXPECT_TRUE(message_of<IoError>([&] { Model{missing}; }).starts_with(missing + ": ")) << missing;

  const std::string broken = write("broken.xml", "<mujoco><worldbody><geom size='1'></mujoco>").string();
  EXPECT_TRUE(message_of<IoError>([&] { Model{broken}; }).starts_with(broken + ": XML parse error"));

  const std::string wrong =
      write("wrong.xml", "<mujoco>\n<worldbody>\n<joint spring='1'/>\n</worldbody></mujoco>").string();
  const std::string words = message_of<IoError>([&] { Model{wrong}; });
  EXPECT_TRUE(words.starts_with(wrong + ": ")) << words;
  EXPECT_NE(words.find("joint"), std::string::npos) << words;
}

struct Planar : Reach {
  static constexpr int velocities = 3;
};

TEST_F(ModelTest, ATaskOfOtherSizesIsAnErrorThatNamesThem) {
  const Model model = load(ball());
  EXPECT_EQ(message_of<std::invalid_argument>([&] { Evaluator(model, Planar{}); }),
            model.file() + ": has 2 velocities (nv), and the task 3: they must be equal");
}

TEST_F(ModelTest, AModelThatCannotBeRolledOutIsAnError) {
  const Model model = load(ball("<option integrator='RK4'/>"));
  EXPECT_EQ(message_of<std::invalid_argument>([&] { Evaluator(model, Reach{}); }),
            model.file() + ": option integrator: RK4 must be Euler or implicit");
}

TEST_F(ModelTest, OptionsOutsideTheirRangeAreErrors) {
  const Model model = load(ball());
  expect_error_with<std::invalid_argument>({"threads"}, [&] { Evaluator(model, Reach{}, {.threads = 0}); });
  expect_error_with<std::invalid_argument>({"physics_steps"},
                                           [&] { Evaluator(model, Reach{}, {.physics_steps = 0}); });
}

TEST_F(ModelTest, TheBoundsOfInputsAreThoseOfTheModel) {
  const Evaluator limited(load(ball()), Reach{}, {.physics_steps = 3});
  EXPECT_EQ(limited.problem().input_min[0], -2);
  EXPECT_EQ(limited.problem().input_max[0], 3);
  EXPECT_DOUBLE_EQ(limited.time_step(), 3 * 0.002);
  const Evaluator unlimited(load(ball("", "<motor joint='slide'/>")), Reach{});
  EXPECT_EQ(unlimited.problem().input_max[0], std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace slalom::mujoco::testing
