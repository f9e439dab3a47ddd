// Replays for every fuzz target its seeds, changed seeds, and the earlier findings in regressions/TARGET/.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "fuzz/target.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::fuzz {
namespace {

class Fuzz : public ::testing::TestWithParam<const Target*> {
 protected:
  bool run(const std::string& bytes, const std::string& which) const {
    try {
      return testing::repeat_if_slow([&] { return GetParam()->run(bytes); });
    } catch (const std::exception& error) {
      ADD_FAILURE() << GetParam()->name << ", " << which << ": " << error.what();
      return false;
    }
  }
};

/// A text after one to four changes: a bit, a byte, a piece that is cut out or repeated, or the end cut off.
std::string changed(std::string text, std::mt19937_64& random) {
  const auto below = [&](std::size_t count) { return random() % std::max<std::size_t>(count, 1); };
  for (std::size_t left = 1 + below(4); left > 0 && !text.empty(); --left) {
    const std::size_t at = below(text.size()),
                      length = 1 + below(std::min<std::size_t>(text.size() - at, 32));
    switch (below(5)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ 1 << below(8));
        break;
      case 1:
        text[at] = static_cast<char>(below(256));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

TEST_P(Fuzz, TakesItsSeeds) {
  const auto seeds = GetParam()->seeds();
  ASSERT_FALSE(seeds.empty());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_LE(seeds[i].size(), GetParam()->max_bytes);
    const bool valid = run(seeds[i], "seed " + std::to_string(i));
    EXPECT_TRUE(valid || i > 0);
  }
}

TEST_P(Fuzz, TakesChangedSeeds) {
  const char* calls = std::getenv("SLALOM_CALLS");
  const long runs = calls ? std::strtol(calls, nullptr, 10) : 60;
  const auto seeds = GetParam()->seeds();
  for (long i = 0; i < runs; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    run(changed(seeds[i % seeds.size()], random), "changed seed " + std::to_string(i));
  }
}

TEST_P(Fuzz, TakesEarlierFindings) {
  run("", "nothing");
  const auto folder = std::filesystem::path(SLALOM_FUZZ_REGRESSIONS) / GetParam()->name;
  if (!std::filesystem::exists(folder)) return;
  for (const auto& file : std::filesystem::directory_iterator(folder))
    run(testing::content(file.path()), file.path().filename().string());
}

INSTANTIATE_TEST_SUITE_P(Target, Fuzz, ::testing::ValuesIn(targets()),
                         [](const auto& each) { return std::string(each.param->name); });

TEST(FuzzRegressions, HaveATargetForEachFolder) {
  if (!std::filesystem::exists(SLALOM_FUZZ_REGRESSIONS)) return;
  for (const auto& folder : std::filesystem::directory_iterator(SLALOM_FUZZ_REGRESSIONS)) {
    const std::string name = folder.path().filename().string();
    EXPECT_TRUE(std::any_of(targets().begin(), targets().end(), [&](const Target* target) {
      return name == target->name;
    })) << folder.path();
  }
}

}  // namespace
}  // namespace slalom::fuzz
