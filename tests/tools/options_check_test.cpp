// The checks of a command line before its command runs, and its parser.
#include "tools/command_line/checks.hpp"

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "tools/command_line/command.hpp"

namespace slalom::tools {
namespace {

using Type = GivenOption::Type;

GivenOption given(const std::string& name, const std::string& value, Type type = Type::text) {
  return {.name = name, .type = type, .values = {value}};
}

class OptionChecks : public testing::TemporaryFolder {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
};

TEST_F(OptionChecks, AcceptsValidOptionsAndWritesNothing) {
  check_options({given("--json", path("a.json")),
                 given("--plot", path("a.png")),
                 given("--seed", "3", Type::natural_number),
                 {.name = "--flag", .type = Type::flag, .values = {"true"}}});
  check_options({given("--json", "/dev/null"), given("--plot", "/dev/null")});
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(OptionChecks, RejectsEmptyNegativeAndUndefinedValues) {
  EXPECT_THROW(check_options({given("--course", "")}), CommandLineError);
  EXPECT_THROW(check_options({given("--seed", "-1", Type::natural_number)}), CommandLineError);
  EXPECT_THROW(check_options({given("--seed", "99999999999999999999", Type::natural_number)}),
               CommandLineError);
  EXPECT_THROW(check_options({given("--seconds", "nan", Type::real_number)}), CommandLineError);
}

TEST_F(OptionChecks, RejectsTwoOutputsInOneFile) {
  EXPECT_THROW(check_options({given("--json", path("a")), given("--record", path("./a"))}), CommandLineError);
  write("in.jsonl", "{}");
  GivenOption input = given("recording", path("in.jsonl"));
  input.positional = true;
  EXPECT_THROW(check_options({input, given("--json", path("in.jsonl"))}), CommandLineError);
  EXPECT_EQ(testing::content(folder_ / "in.jsonl"), "{}");
}

TEST_F(OptionChecks, RejectsOutputsThatCannotBeWritten) {
  EXPECT_THROW(check_options({given("--json", path("no/folder.json"))}), IoError);
  EXPECT_THROW(check_options({given("--json", folder_.string())}), IoError);
  EXPECT_THROW(check_options({given("--plot", path("a.jpg"))}), CommandLineError);
  EXPECT_THROW(check_options({given("--record", "-")}), CommandLineError);
  check_options({given("--json", "-")});
}

/// What a command `try` was given.
struct Values {
  std::string text = "default";
  std::vector<std::string> list, repeated;
  double real = 0;
  int ran = 0;
} values;

int run(const std::vector<const char*>& arguments) {
  values = {};
  std::vector<const char*> all{"slalom"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const auto declare = [](Subcommand& command) {
    command.summary("For tests");
    command.option("--text", values.text, "A text").show_default();
    command.option("--list", values.list, "A list").comma_separated();
    const Option repeated = command.option("--set", values.repeated, "Repeated").repeatable();
    command.option("--real", values.real, "A number").range(0.0, 1.0).needs(repeated);
    command.action([] {
      ++values.ran;
      return values.text == "fail" ? throw std::runtime_error("failed") : 7;
    });
  };
  return run_command_line(static_cast<int>(all.size()), all.data(), {{"try", declare}});
}

TEST(Command, SetsItsVariablesAndReturnsTheStatus) {
  EXPECT_EQ(run({"try", "--list", "a,b", "--set", "x=1", "--set", "y=2", "--real", "0.5"}), 7);
  EXPECT_EQ(values.text, "default");
  EXPECT_EQ(values.list, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(values.repeated, (std::vector<std::string>{"x=1", "y=2"}));
  EXPECT_DOUBLE_EQ(values.real, 0.5);
  EXPECT_EQ(values.ran, 1);
}

TEST(Command, RejectsInvalidCommandLines) {
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"other"}), 2);
  EXPECT_EQ(run({"try", "--unknown"}), 2);
  EXPECT_EQ(run({"try", "--real", "0.5"}), 2) << "--real needs --set";
  EXPECT_EQ(run({"try", "--set", "x", "--real", "2"}), 2) << "out of range";
  EXPECT_EQ(run({"try", "--text", ""}), 2);
  EXPECT_EQ(values.ran, 0);
  EXPECT_EQ(run({"try", "--text", "fail"}), 1);
  EXPECT_EQ(run({"try", "--help"}), 0);
}

}  // namespace
}  // namespace slalom::tools
