// Configuration files and keys: every mistake has a message with file, line, key, value and rule.
#include "slalom/vehicle/configuration/configuration.hpp"

#include "slalom/core/error.hpp"
#include "slalom/vehicle/published/options.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::vehicle::configuration_test {
namespace {

class ConfigurationFile : public testing::TemporaryFolder {
 protected:
  /// The message, without the folder, with which a file of this text is refused.
  std::string refusal(const std::string& text) const {
    const std::string message = message_of<IoError>([&] { load_configuration(write("x.yaml", text)); }),
                      before = (folder_ / "").string();
    return message.rfind(before, 0) == 0 ? message.substr(before.size()) : message;
  }
};

TEST_F(ConfigurationFile, SetsWhatItSaysAndKeepsTheRest) {
  const auto c = load_configuration(write(
      "a.yaml",
      "vehicle:\n  model: published\n  bicycle: published\nplanner: {max_speed: 6, verify_plan: false}\n"));
  EXPECT_EQ(c.vehicle.model, vehicle_model("published"));
  EXPECT_EQ(c.vehicle.own_of<published::ModelOptions>().bicycle, published::BicycleModel::published);
  EXPECT_EQ(c.planner.max_speed, 6);
  EXPECT_FALSE(c.planner.verify_plan);
  EXPECT_EQ(c.vehicle.time_step, PathTrackingOptions{}.time_step);
  EXPECT_NO_THROW(load_configuration(write("empty.yaml", "")));
}

TEST_F(ConfigurationFile, StartsFromAnother) {
  write("mother.yaml", "vehicle: {rear_length: 0.135, dead_time: 0.03}\n");
  const auto c =
      load_configuration(write("child.yaml", "base: mother\nvehicle: {dead_time: 0.01}\n"), {folder_});
  EXPECT_EQ(c.vehicle.rear_length, 0.135);
  EXPECT_EQ(c.vehicle.dead_time, 0.01);
  EXPECT_NE(refusal("base: x.yaml\n").find("cycle"), std::string::npos);
  EXPECT_EQ(refusal("\nbase: nobody\n")
                .rfind("x.yaml:2: key base: 'nobody' is neither a file nor the name of a configuration", 0),
            0u);
}

TEST_F(ConfigurationFile, ErrorsNameFileLineKeyValueAndRule) {
  EXPECT_EQ(
      refusal("vehicle:\n  time_stap: 0.05\n"),
      "x.yaml:2: key vehicle.time_stap: unknown option of section vehicle; did you mean vehicle.time_step?");
  EXPECT_EQ(refusal("\nvehicle:\n  time_step: 7\n"),
            "x.yaml:3: key vehicle.time_step: '7' must be in [0.001, 1]");
  EXPECT_EQ(refusal("vehicle:\n  time_step: \"0.05\"\n"),
            "x.yaml:2: key vehicle.time_step: '0.05' must not be quoted");
  EXPECT_EQ(refusal("vehicle:\n  dead_time: 0\n  dead_time: 0.01\n"),
            "x.yaml:3: key vehicle.dead_time: duplicate key");
  EXPECT_EQ(refusal("vehicle: 3\n"), "x.yaml:1: key vehicle: '3' must be a map of options to values");
  EXPECT_EQ(refusal("vehicle:\n  dead_time: {a: 1}\n"),
            "x.yaml:2: key vehicle.dead_time: must have a value, or a list of values");
  EXPECT_NE(
      refusal("vehicel: {dead_time: 0}\n").find("x.yaml:1: key vehicel: unknown section; must be one of"),
      std::string::npos);
  EXPECT_NE(refusal("vehicel: {dead_time: 0}\n").find("did you mean vehicle?"), std::string::npos);
  EXPECT_EQ(refusal("- 1\n"), "x.yaml:1: must be a map of sections");
  EXPECT_NE(refusal("vehicle: {a: [}\n").find("x.yaml:1: is not YAML"), std::string::npos);
  EXPECT_EQ(refusal("vehicle: {dead_time: .nan}\n"),
            "x.yaml:1: key vehicle.dead_time: '.nan' must be a number");
}

TEST_F(ConfigurationFile, RejectsDuplicateKeys) {
  EXPECT_EQ(refusal("vehicle: {dead_time: 0}\n---\nvehicle: {dead_time: 0.01}\n"),
            "x.yaml:3: must have only one YAML document, this is a second one");
  EXPECT_EQ(refusal("vehicle: {dead_time: 0}\nvehicle: {dead_time: 0.01}\n"),
            "x.yaml:2: key vehicle: duplicate key");
  EXPECT_EQ(refusal("---\nvehicle: {dead_time: 0}\n...\n"), "accepted") << "marks of one document";
}

TEST_F(ConfigurationFile, NamesTheLineOfAValueThatAMethodRejects) {
  EXPECT_EQ(refusal("mppi:\n  input_min: 1\n  input_max: -1\n"),
            "x.yaml:3: key mppi.input_min: '1' must be at most mppi.input_max, '-1'");
  EXPECT_EQ(refusal("svg_mppi:\n  variance: [1, 2, 3]\n"),
            "x.yaml:2: key svg_mppi.variance: '[1, 2, 3]' has 3 values, must have 1: the input of "
            "vehicle.model 'kinematic': steering");
  EXPECT_EQ(refusal("svg_mppi:\n  variance: [1, 2]\nvehicle:\n  model: kinematic_acceleration\n"), "accepted")
      << "whatever the order";
  EXPECT_EQ(refusal("svg_mppi:\n  variance: [1, 2, 3]\nvehicle:\n  model: kinematic_acceleration\n"),
            "x.yaml:2: key svg_mppi.variance: '[1, 2, 3]' has 3 values, must have 1 or 2: the inputs of "
            "vehicle.model 'kinematic_acceleration': steering and acceleration");
  write("two.yaml", "svg_mppi: {variance: [1, 2]}\nvehicle: {model: kinematic_acceleration}\n");
  EXPECT_EQ(refusal("base: two.yaml\nvehicle:\n  model: kinematic\n"),
            "x.yaml:3: key vehicle.model: the model has only the input steering, but svg_mppi.variance has 2 "
            "values in the base");
  EXPECT_EQ(
      refusal("vehicle: {model: kinematic_acceleration}\nmppi:\n  input_min: [-1, 3]\n  input_max: [1, 2]\n"),
      "x.yaml:4: key mppi.input_min: '3' must be at most mppi.input_max, '2'");
  EXPECT_EQ(refusal("svg_mppi:\n  temperature:\n  samples: 10\n"),
            "x.yaml:2: key svg_mppi.temperature: must have a value");
  EXPECT_NE(refusal("svg_mppi:\n  samples: 10\n\ttemperature: 1\n").find("begins with a tab"),
            std::string::npos);
}

TEST_F(ConfigurationFile, IsWrittenAsItIsRead) {
  Configuration c;
  c.vehicle.model = vehicle_model("published");
  c.vehicle.own_of<published::ModelOptions>().bicycle = published::BicycleModel::published;
  c.planner.max_speed = 1.0 / 3;
  const auto back = load_configuration(write("back.yaml", to_yaml(c)));
  EXPECT_EQ(to_yaml(back), to_yaml(c));
  EXPECT_EQ(back.planner.max_speed, c.planner.max_speed);
}

// Shares of the grip for parts of the path, however many inputs the model has.
TEST_F(ConfigurationFile, HasAnyNumberOfGripShares) {
  const std::vector<double> shares{0.9, 0.8, 0.7, 1};
  for (const char* model : {"kinematic", "single_track"}) {
    Configuration c;
    c.vehicle.model = vehicle_model(model);
    set_option(c, "planner.grip_shares", "[0.9, 0.8, 0.7, 1]");
    EXPECT_EQ(c.planner.grip_shares.values(), shares);
    const auto file = write("learned.yaml", to_yaml(c));
    EXPECT_EQ(load_configuration(file).planner.grip_shares.values(), shares);
    const auto based = load_configuration(write("based.yaml", "base: learned.yaml\n"));
    EXPECT_EQ(based.planner.grip_shares.values(), shares);
  }
  EXPECT_EQ(refusal("planner:\n  grip_shares: [0.9, 2]\n"),
            "x.yaml:2: key planner.grip_shares: '2' must be in [0.05, 1]");
}

TEST_F(ConfigurationFile, IsFoundByName) {
  write("mine.yaml", "");
  EXPECT_EQ(find_configuration("mine", {folder_}), folder_ / "mine.yaml");
  EXPECT_EQ(find_configuration((folder_ / "mine.yaml").string(), {}), folder_ / "mine.yaml");
  expect_error_with<IoError>({"known: mine"}, [&] { find_configuration("yours", {folder_}); });
  EXPECT_THROW(load_configuration(folder_ / "none.yaml"), IoError);
}

TEST(ConfigurationKey, IsSetFromText) {
  Configuration c;
  set_option(c, "planner.max_speed", "6");
  EXPECT_EQ(c.planner.max_speed, 6);
  set_option(c, "latency", "0.02", "planner");
  EXPECT_EQ(c.planner.latency, 0.02);
  const auto refusal = [&](const char* key, const char* value) {
    return message_of([&] { set_option(c, key, value); });
  };
  EXPECT_EQ(refusal("planner.max_speed", "0"), "key planner.max_speed: '0' must be in [0.01, 100]");
  EXPECT_EQ(refusal("planner.max_sped", "5"),
            "key planner.max_sped: unknown option of section planner; did you mean planner.max_speed?");
  EXPECT_NE(refusal("speed", "5").find("section.option"), std::string::npos);
  EXPECT_EQ(c.planner.max_speed, 6);
  const std::string before = to_yaml(c);
  EXPECT_NE(refusal("mppi.variance", "[1, 2]").find("key mppi.variance: '[1, 2]' has 2 values"),
            std::string::npos);
  EXPECT_EQ(to_yaml(c), before) << "what is refused changes nothing";
}

TEST(ConfigurationKey, IsNamedWhereAMethodRejectsIt) {
  Configuration c;
  set_option(c, "mppi.input_min", "1");
  set_option(c, "mppi.input_max", "-1");
  EXPECT_EQ(message_of([&] { make_solver(c, "mppi", 1); }),
            "mppi.input_min: 1 must be at most input_max, -1");
}

template <class Options>
void expect_equal(const Options& file, const Options& ours) {
  const auto a = list_options(file), b = list_options(ours);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].declaration.name;
}

// The vehicle and the planner of the golden tests are those of `--config published`.
TEST(PublishedConfiguration, HasThePublishedVehicleAndPlanner) {
  const Configuration file = load_configuration(SLALOM_CONFIGS "/published.yaml");
  expect_equal(file.vehicle, published::vehicle_options());
  expect_equal(file.planner, published::planner_options());
}

}  // namespace
}  // namespace slalom::vehicle::configuration_test
