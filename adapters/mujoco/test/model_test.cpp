#include <gtest/gtest.h>

#include <string>

#include "models.hpp"
#include "slalom/core/error.hpp"
#include "slalom/mujoco/evaluator.hpp"

namespace slalom::mujoco::testing {
namespace {

/// The words of what a function throws; empty if it throws nothing of this type.
template <class Error, class Function>
std::string thrown(Function&& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(ModelTest, AFileThatIsMissingOrNoModelIsAnErrorWithItsNameAndMuJoCosMessage) {
  const std::string missing = (folder_ / "missing.xml").string();
  EXPECT_TRUE(thrown<IoError>([&] { Model{missing}; }).starts_with(missing + ": ")) << missing;

  const std::string broken = write("broken.xml", "<mujoco><worldbody><geom size='1'></mujoco>").string();
  EXPECT_TRUE(thrown<IoError>([&] { Model{broken}; }).starts_with(broken + ": XML parse error"));

  const std::string wrong =
      write("wrong.xml", "<mujoco>\n<worldbody>\n<joint spring='1'/>\n</worldbody></mujoco>").string();
  const std::string words = thrown<IoError>([&] { Model{wrong}; });
  EXPECT_TRUE(words.starts_with(wrong + ": ")) << words;
  EXPECT_NE(words.find("joint"), std::string::npos) << words;
}

TEST_F(ModelTest, FindsElementsByTheirNames) {
  const Model model = load(ball());
  EXPECT_EQ(model.id(mjOBJ_BODY, "ball"), 1);
  EXPECT_EQ(model.position_of("height"), 1);
  EXPECT_EQ(model.velocity_of("height"), 1);
  EXPECT_EQ(thrown<std::invalid_argument>([&] { model.id(mjOBJ_BODY, "box"); }),
            model.file() + ": has no body with the name 'box'");
}

struct Planar : Reach {
  static constexpr int velocities = 3;
};

TEST_F(ModelTest, ATaskOfOtherSizesIsAnErrorThatNamesThem) {
  const Model model = load(ball());
  EXPECT_EQ(thrown<std::invalid_argument>([&] { Evaluator(model, Planar{}); }),
            model.file() + ": has 2 velocities (nv), and the task 3: they must be equal");
}

TEST_F(ModelTest, AModelThatCannotBeRolledOutIsAnError) {
  const Model model = load(ball("<option integrator='RK4'/>"));
  EXPECT_EQ(thrown<std::invalid_argument>([&] { Evaluator(model, Reach{}); }),
            model.file() + ": option integrator: RK4 must be Euler or implicit");
}

TEST_F(ModelTest, OptionsOutsideTheirRangeAreErrors) {
  const Model model = load(ball());
  EXPECT_NE(thrown<std::invalid_argument>([&] { Evaluator(model, Reach{}, {.threads = 0}); }).find("threads"),
            std::string::npos);
  EXPECT_NE(thrown<std::invalid_argument>([&] {
              Evaluator(model, Reach{}, {.physics_steps = 0});
            }).find("physics_steps"),
            std::string::npos);
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
