// Recordings in JSON lines that were cut: what is whole of them is written out.
#include "tools/json_lines/json_repair.hpp"

#include <sstream>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::tools {
namespace {

class JsonRepair : public testing::TemporaryFolder {
 protected:
  std::string recording(const std::string& text) const { return write("lap.jsonl", text).string(); }
};

const std::string first = "{\"type\":\"recording\"}\n", lap = "{\"type\":\"lap\",\"lap\":0}\n";

TEST_F(JsonRepair, KeepsEveryWholeLineWhereverItWasCut) {
  const std::string whole = first + lap + lap;
  for (std::size_t size = first.size() - 1; size <= whole.size(); ++size) {
    const std::string file = recording(whole.substr(0, size));
    EXPECT_TRUE(is_json_recording(file));
    std::ostringstream out;
    const RepairedLines done = repair_json_recording(file, out);
    // A record whose newline alone is missing is whole.
    std::string expected = first;
    for (std::size_t end = first.size() + lap.size(); end - 1 <= size; end += lap.size()) expected += lap;
    EXPECT_EQ(out.str(), expected) << size;
    EXPECT_EQ(done.lost, size > expected.size() ? size - expected.size() : 0) << size;
    EXPECT_EQ(done.records, 1 + (expected.size() - first.size()) / lap.size()) << size;
  }
}

TEST_F(JsonRepair, ChangedLinesAndOtherFilesAreRefused) {
  const auto refused = [&](const std::string& text, const std::vector<const char*>& words) {
    std::ostringstream out;
    const std::string file = recording(text);
    expect_error_with<IoError>(words, [&] { repair_json_recording(file, out); });
  };
  refused(first + "{\"type\":\n" + lap, {"lap.jsonl:2: must be a record of a recording"});
  refused(lap + first, {"lap.jsonl:1: must be the first line of a recording"});
  refused("{\"type\":\"rec", {"lap.jsonl: has no whole record"});
  refused("", {"lap.jsonl: has no whole record"});
  EXPECT_FALSE(is_json_recording(recording("\x89MCAP")));
  EXPECT_FALSE(is_json_recording((folder_ / "absent.jsonl").string()));
}

}  // namespace
}  // namespace slalom::tools
