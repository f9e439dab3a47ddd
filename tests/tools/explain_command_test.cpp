// `slalom explain`: figures of the paper, and mistakes named in words.
#include <set>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

class ExplainCommand : public testing::ProgramTest {};

TEST_F(ExplainCommand, DrawsFiguresOfThePaper) {
  std::set<std::string> pictures;
  for (const std::string figure : {"1", "3", "4"}) {
    succeed("explain --figure " + figure + " --plot f" + figure + ".svg");
    pictures.insert(testing::content(folder_ / ("f" + figure + ".svg")));
  }
  EXPECT_EQ(pictures.size(), 3u);
  for (const std::string& picture : pictures) EXPECT_EQ(picture.rfind("<?xml", 0), 0u);
}

TEST_F(ExplainCommand, NamesMistakes) {
  expect_refused("explain --figure 2 --plot f.svg", {"'2' must be 1, 3 or 4"}, 2);
  expect_refused("explain --figure 3", {"--plot: is required"}, 2);
}

}  // namespace
}  // namespace slalom::tools
