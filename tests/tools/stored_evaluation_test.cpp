// Settings of an evaluation that no evaluation has are refused by name; from the others its laps are made
// again.
#include "tools/evaluation/stored_evaluation.hpp"

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "tools/evaluation/evaluation_job.hpp"

namespace slalom::tools {
namespace {

class StoredSettings : public testing::TemporaryFolder {
 protected:
  /// The error message for a folder without laps whose settings have these experiments and this seed.
  std::string complaint(const std::string& experiments, const std::string& seed0 = "0") const {
    write("laps.csv", evaluation::checked_header() + "\n");
    write("settings.json",
          evaluation::with_checksum("{\"experiments\": [" + experiments + "], \"seed0\": " + seed0 + "}"));
    return message_of<IoError>([&] { load_evaluation(folder_); });
  }
  static std::string experiment(const std::string& laps) {
    return R"({"method": "mppi", "set": "", "scenario": "oa", "obstacles": 5, "laps": )" + laps + "}";
  }
};

TEST_F(StoredSettings, NeedAnExperiment) {
  EXPECT_EQ(complaint(experiment("3")), "accepted");
  EXPECT_NE(complaint("").find("settings.json: is invalid: experiments: must be at least one"),
            std::string::npos);
}

TEST_F(StoredSettings, WholeNumbersAreNotCutToFit) {
  EXPECT_NE(complaint(experiment("4294967298")).find("4294967298"), std::string::npos);
  EXPECT_NE(complaint(experiment("0")).find("laps: 0 must be in [1, 1000000]"), std::string::npos);
  EXPECT_NE(complaint(experiment("3"), "1e30").find("must be a whole number"), std::string::npos);
}

}  // namespace
}  // namespace slalom::tools
