// Stored laps survive: damage shows, two stores do not mix, folders are synced.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/evaluation.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::evaluation {
namespace {

namespace fs = std::filesystem;

class StoredLaps : public testing::TemporaryFolder {
 protected:
  StoredLaps() {
    evaluation_.experiments = {{"mppi", {}, "oa", 5, 3}};
    evaluation_.settings = R"({"course": "wren", "latency_ms": 0.1, "seed0": 0})";
  }

  LapRow row(int lap) const {
    LapRow r;
    r.lap = lap;
    r.seed = lap_seed(0, lap, 5);
    r.state_cost = 1.0 / (lap + 3);
    r.contact_points = "1.250:-3.000";
    r.wall_time = 0.125;
    return r;
  }
  /// Stores all laps, with a table at the end or with the journal only.
  void store(bool complete) {
    LapStore store(folder_, evaluation_, false);
    for (int lap = 0; lap < 3; ++lap) store.add(row(lap));
    if (complete) store.complete();
  }
  std::string text(const fs::path& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// Reads the text as a table; the lines of its rows, or what is wrong.
  std::string read(const std::string& bytes, bool journal) const {
    try {
      std::string lines;
      const fs::path file = write("damaged.csv", bytes);
      for (const LapRow& each : read_rows(file, evaluation_.experiments, journal, 0))
        lines += csv_line(each, evaluation_.experiments) + "\n";
      return lines;
    } catch (const IoError& error) {
      return error.what();
    }
  }

  Evaluation evaluation_;
};

/// The hash tells any change of a byte; of each byte one bit is tried.
TEST_F(StoredLaps, ABitThatChangesShowsInEveryByte) {
  for (const bool journal : {false, true}) {
    fs::remove_all(folder_);
    store(!journal);
    const std::string whole = text(journal ? "laps.journal.csv" : "laps.csv"), rows = read(whole, journal);
    ASSERT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3);
    // A journal may lose its last line: it could have been cut, and the lap is driven again.
    const std::string without_last = rows.substr(0, rows.rfind('\n', rows.size() - 2) + 1);
    int accepted = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 1 << (5 * at + 3) % 8);
      const std::string seen = read(damaged, journal);
      if (journal && seen == without_last) continue;
      accepted += seen.find("damaged.csv:") == std::string::npos;
    }
    EXPECT_EQ(accepted, 0) << "of " << whole.size() << " bits";
  }
}

TEST_F(StoredLaps, SettingsThatWereChangedShow) {
  store(true);
  const std::string settings = text("settings.json");
  EXPECT_NO_THROW(verify_checksum(settings));
  EXPECT_THROW(verify_checksum(evaluation_.settings), std::invalid_argument) << "without a checksum";
  const auto meaning = nlohmann::ordered_json::parse(settings);
  for (std::size_t at = 0; at < settings.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = settings;
      damaged[at] = static_cast<char>(damaged[at] ^ 1 << bit);
      try {
        verify_checksum(damaged);
        EXPECT_EQ(nlohmann::ordered_json::parse(damaged), meaning);
      } catch (const std::invalid_argument&) {
      }
    }
}

TEST_F(StoredLaps, SettingsOfAnyDepthAreRefused) {
  store(false);
  for (const int depth : {100, 1000000}) {
    const std::size_t brackets = static_cast<std::size_t>(depth);
    write("settings.json", "{\"a\": " + std::string(brackets, '[') + std::string(brackets, ']') + "}");
    try {
      const LapStore store(folder_, evaluation_, true);
      ADD_FAILURE() << "settings of depth " << depth << " were taken";
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("settings.json: must not nest deeper than 64 levels"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST_F(StoredLaps, ResumesOnlyFromAWholeTableOfItsOwn) {
  store(true);
  const std::string table = text("laps.csv");
  const auto complaint = [&](const std::string& bytes) -> std::string {
    write("laps.csv", bytes);
    try {
      LapStore(folder_, evaluation_, true);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(complaint(table), "");
  EXPECT_NE(complaint("").find("laps.csv:1: the header"), std::string::npos);
  EXPECT_NE(complaint(table.substr(0, table.rfind('\n', table.size() - 2) + 1)).find("1 laps are missing"),
            std::string::npos);
  evaluation_.seed0 = 5;
  EXPECT_NE(complaint(table).find("laps.csv:2: seed: 0"), std::string::npos);
}

TEST_F(StoredLaps, AFolderHasOneStoreAtATime) {
  {
    LapStore first(folder_, evaluation_, false);
    first.add(row(0));
    try {
      const LapStore store(folder_, evaluation_, true);
      ADD_FAILURE() << "the second store got in";
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("is in use by another process"), std::string::npos)
          << error.what();
    }
    first.add(row(1));
  }
  EXPECT_EQ(LapStore(folder_, evaluation_, true).rows().size(), 2u);
}

}  // namespace
}  // namespace slalom::evaluation
