// laps.csv reads back to the same bits, errors name line and column; damage shows, and two stores do not mix.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/evaluation.hpp"
#include "slalom/evaluation/lap_table.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation::stored_laps_test {
namespace {

namespace fs = std::filesystem;

const std::vector<Experiment> experiments{
    {"mppi", {}, "pt", 0, 3},
    {"svg_mppi", {{"svg_mppi.variance", "0.075"}, {"vehicle.dead_time", "0"}}, "oa", 5, 2}};

LapRow row(int experiment, int lap) {
  LapRow r;
  r.experiment = experiment;
  r.lap = lap;
  r.seed = lap_seed(0, lap, experiment == 0 ? 0 : 5);
  r.success = true;
  r.collisions = 3;
  r.finished = true;
  r.state_cost = 0.1 + 0.2;
  r.collision_cost = 1e-300;
  r.time = 1.0 / 3;
  r.min_clearance = -0.0125;
  r.collision_points = "1.250:-3.000 0.500:2.125";
  r.solve_p99 = 12.5;
  return r;
}

TEST(LapTableColumns, IncludeThoseOfTheTrackerIfAnExperimentUsesOne) {
  std::vector<Experiment> tracking = experiments;
  tracking[1].set.emplace_back("world.tracking", "off");
  EXPECT_FALSE(tracking[1].tracks());
  EXPECT_EQ(csv_header(tracking), csv_header());
  tracking[1].set.back().second = "exact";
  EXPECT_TRUE(tracking[1].tracks());
  EXPECT_EQ(csv_header(tracking).rfind(csv_header() + ",tracking_in_view,", 0), 0U);
  LapRow r = row(1, 0);
  r.tracking = {100, 99, 80, 79, 2, 0.1 + 0.2, 0.25, 1.0 / 3, 0.5};
  const LapRow back = parse_line(csv_line(r, tracking), tracking);
  EXPECT_EQ(back.tracking.long_detected, 79);
  EXPECT_EQ(back.tracking.false_objects, 2);
  EXPECT_EQ(back.tracking.position_error, 0.1 + 0.2);
  EXPECT_EQ(back.tracking.yaw_error, 1.0 / 3);
  EXPECT_THROW(parse_line(csv_line(r, experiments), tracking), std::invalid_argument);
}

TEST(LapTableColumns, TellWhetherALapBeganInContact) {
  LapRow r = row(1, 0);
  EXPECT_TRUE(began_in_contact(r, {1.24, -3.01, 0.3}));
  EXPECT_FALSE(began_in_contact(r, {0.5, 2.125, 0})) << "the place of the second collision";
  r.collision_points = "";
  EXPECT_FALSE(began_in_contact(r, {0, 0, 0}));
}

class LapTable : public testing::TemporaryFolder {
 protected:
  std::vector<LapRow> read(const std::string& text, bool accept_truncated = false,
                           std::uint64_t seed0 = 0) const {
    return read_rows(write("laps.csv", text), experiments, accept_truncated, seed0);
  }
  /// Expects that this text is refused in these words.
  void refuses(const std::string& text, const char* words, bool accept_truncated = false,
               std::uint64_t seed0 = 0) const {
    expect_error_with<IoError>({words}, [&] { read(text, accept_truncated, seed0); });
  }

  static std::string line(const LapRow& row) { return checked_line(csv_line(row, experiments)) + "\n"; }
  std::string head_ = checked_header() + "\n", first_ = line(row(0, 2)), second_ = line(row(1, 0));
};

TEST_F(LapTable, ReadsBackToTheSameBits) {
  const auto rows = read(head_ + first_ + second_);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(std::tuple(rows[0].experiment, rows[0].lap, rows[0].seed, rows[1].experiment),
            std::tuple(0, 2, 10u, 1));
  EXPECT_EQ(rows[1].state_cost, 0.1 + 0.2);
  EXPECT_EQ(rows[1].collision_cost, 1e-300);
  EXPECT_EQ(rows[1].time, 1.0 / 3);
  EXPECT_EQ(rows[1].collision_points, "1.250:-3.000 0.500:2.125");
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(line(rows[i]), i == 0 ? first_ : second_);
}

TEST_F(LapTable, HasTheFiguresOfALapUnderTheirNames) {
  std::string names = "method,scenario,set,lap";
  const LapFigures lap;
  visit_figures(lap, [&](const auto&, const Figure& figure) { names += std::string(",") + figure.name; });
  EXPECT_EQ(head_.rfind(names + ",", 0), 0u) << head_;
  const std::string page = testing::content(SLALOM_COURSES "/../docs/command-line.md");
  visit_figures(lap, [&](const auto&, const Figure& figure) {
    EXPECT_NE(page.find("`" + std::string(figure.name) + "`"), std::string::npos) << figure.name;
  });
}

TEST_F(LapTable, TellsTheSameLapWithoutItsTimesOnTheClock) {
  LapRow one = row(0, 2), other = one;
  other.solve_p99 += 1;
  other.wall_time += 1;
  other.tracking.in_view += 1;  // no column, since no experiment tracks
  EXPECT_TRUE(same_lap(one, other, experiments));
  other.min_clearance += 1e-15;
  EXPECT_FALSE(same_lap(one, other, experiments));
}

TEST_F(LapTable, AcceptsATruncatedLineOnlyAtTheEndOfAJournal) {
  const std::string cut = second_.substr(0, second_.size() / 2);
  EXPECT_EQ(read(head_ + first_ + cut, true).size(), 1u);
  refuses(head_ + first_ + cut, ":3: is truncated");
  refuses(head_ + cut + "\n" + first_, ":2: checksum", true);
}

TEST_F(LapTable, NamesLineAndColumnOfAnInvalidValue) {
  const std::string plain = csv_line(row(0, 2), experiments), seed = ",,2,10,";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = plain;
    text.replace(text.find(from), from.size(), to);
    return head_ + checked_line(text) + "\n";
  };
  refuses("lap,seed\n" + first_, ":1: the columns must be method,");
  refuses("lap,seed\n" + first_, "of another version of the program");
  refuses(head_ + first_ + first_, ":3: duplicate lap");
  refuses(changed("mppi", "cem"), ":2: matches no experiment");
  refuses(changed(seed, ",,3,10,"), "lap: 3 must be in [0, 2]");
  refuses(changed(seed, ",,2,twelve,"), "seed: 'twelve' must be a number");
}

TEST_F(LapTable, RejectsNonFiniteNumbers) {
  LapRow invalid = row(0, 2);
  for (const double number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    invalid.state_cost = number;
    refuses(head_ + line(invalid), ":2: state_cost: '");
  }
  invalid = row(0, 2);
  invalid.min_clearance = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(read(head_ + line(invalid))) << "where there is no wall";
}

TEST_F(LapTable, RejectsTheSeedOfAnotherLap) {
  LapRow plain = row(0, 2), among_obstacles = row(1, 1);
  plain.seed = 7 + 2 * 5;
  among_obstacles.seed = 7 + 1 * 10;
  const auto text = [&] { return head_ + line(plain) + line(among_obstacles); };
  EXPECT_NO_THROW(read(text(), false, 7));
  refuses(text(), ":2: seed: 17 must be 18", false, 8);
  among_obstacles.seed = 7 + 1 * 5;
  refuses(text(), ":3: seed: 12 must be 17", true, 7);
}

TEST_F(LapTable, NamesAMissingHeader) {
  refuses("", ".csv:1: the header is missing");
  EXPECT_NO_THROW(read("", true)) << "a journal that was killed at once";
}

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
    r.collision_points = "1.250:-3.000";
    r.wall_time = 0.125;
    return r;
  }
  /// Stores all laps, with a table at the end or with the journal only.
  void store(bool complete) {
    LapStore store(folder_, evaluation_, false);
    for (int lap = 0; lap < 3; ++lap) store.add(row(lap));
    if (complete) store.complete();
  }
  std::string text(const fs::path& file) const { return testing::content(folder_ / file); }
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

TEST_F(StoredLaps, ResumesOnlyFromAWholeTableOfItsOwn) {
  store(true);
  const std::string table = text("laps.csv");
  const auto resume = [&] { LapStore(folder_, evaluation_, true); };
  EXPECT_NO_THROW(resume());
  write("laps.csv", "");
  expect_error_with<IoError>({"laps.csv:1: the header"}, resume);
  write("laps.csv", table.substr(0, table.rfind('\n', table.size() - 2) + 1));
  expect_error_with<IoError>({"1 laps are missing"}, resume);
  write("laps.csv", table);
  evaluation_.seed0 = 5;
  expect_error_with<IoError>({"laps.csv:2: seed: 0"}, resume);
}

TEST_F(StoredLaps, AFolderHasOneStoreAtATime) {
  {
    LapStore first(folder_, evaluation_, false);
    first.add(row(0));
    expect_error_with<IoError>({"is in use by another process"},
                               [&] { LapStore(folder_, evaluation_, true); });
    first.add(row(1));
  }
  EXPECT_EQ(LapStore(folder_, evaluation_, true).rows().size(), 2u);
}

TEST_F(StoredLaps, SettingsOfAnyDepthAreRefused) {
  store(false);
  for (const int depth : {100, 1000000}) {
    const std::size_t brackets = static_cast<std::size_t>(depth);
    write("settings.json", "{\"a\": " + std::string(brackets, '[') + std::string(brackets, ']') + "}");
    expect_error_with<IoError>({"settings.json: must not nest deeper than 64 levels"},
                               [&] { LapStore(folder_, evaluation_, true); });
  }
}

}  // namespace
}  // namespace slalom::evaluation::stored_laps_test
