#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <map>
#include <system_error>

#include "evaluation/json.hpp"
#include "evaluation/system_files.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/evaluation.hpp"
#include "slalom/evaluation/result_folder.hpp"

namespace slalom::evaluation {

namespace {

namespace fs = std::filesystem;
using detail::throw_system;
using detail::write_all;
constexpr const char* journal_name = "laps.journal.csv";
constexpr const char* table_name = "laps.csv";
constexpr const char* settings_name = "settings.json";

constexpr const char* checksum_key = "checksum";

/// The 64-bit FNV-1a hash of the settings, written with their keys in order.
std::string checksum_of(const Json& settings) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : json_text(settings)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

/// The rows as a table with checksums.
std::string table_text(const std::vector<LapRow>& rows, const std::vector<Experiment>& experiments) {
  std::string text = checked_header(experiments) + "\n";
  for (const LapRow& row : rows) text += checked_line(csv_line(row, experiments)) + "\n";
  return text;
}

/// The values below `json` by their paths, in the order of the paths.
std::map<std::string, Json> values_by_path(const Json& json) {
  const Json flat = json.flatten();
  std::map<std::string, Json> values;
  for (const auto& [path, value] : flat.items()) values.emplace(path, value);
  return values;
}

/// "key: 1 stored, 2 requested; ..." for every value that differs.
std::string differences(const Json& stored, const Json& requested) {
  std::string text;
  const auto a = values_by_path(stored), b = values_by_path(requested);
  const auto note = [&](const std::string& key, const std::string& x, const std::string& y) {
    text += (text.empty() ? "" : "; ") + key.substr(1) + ": " + x + " stored, " + y + " requested";
  };
  for (const auto& [key, value] : a) {
    const auto other = b.find(key);
    if (other == b.end()) {
      note(key, json_text(value), "nothing");
    } else if (!(other->second == value)) {
      note(key, json_text(value), json_text(other->second));
    }
  }
  for (const auto& [key, value] : b) {
    if (!a.contains(key)) note(key, "nothing", json_text(value));
  }
  return text;
}

/// The contents of settings.json besides the settings.
struct StoredSettings {
  std::string build;     ///< that drove the laps; "" if it is unknown
  bool checked = false;  ///< whether they have a checksum
};

/// Throws IoError if the stored settings are damaged or others than those requested.
StoredSettings check_settings(const fs::path& file, const std::string& requested) {
  StoredSettings result;
  Json stored;
  try {
    const std::string text = read_file(file, max_json_bytes);
    result.checked = verify_checksum(text);
    stored = parse_json(text);
  } catch (const std::invalid_argument& error) {
    throw IoError(file.string(), 0, error.what());
  }
  if (const auto build = stored.find("build"); build != stored.end() && build->is_string())
    result.build = build->get<std::string>();
  stored.erase("build");
  stored.erase(checksum_key);
  const std::string differing = differences(stored, parse_json(requested));
  if (!differing.empty())
    throw IoError(file.string(), 0, "the folder contains an evaluation with other settings: " + differing);
  return result;
}

std::string with_build(const std::string& settings, const std::string& build) {
  Json json = parse_json(settings);
  if (!build.empty()) json["build"] = build;
  return with_checksum(json_text(json));
}

bool is_table_order(const LapRow& a, const LapRow& b) {
  return std::pair(a.experiment, a.lap) < std::pair(b.experiment, b.lap);
}

/// laps.csv is written when all laps are there. If some are missing, somebody has edited it.
void check_complete(const fs::path& table, const std::vector<LapRow>& sorted,
                    const std::vector<Experiment>& experiments) {
  std::size_t at = 0;
  for (int e = 0; e < static_cast<int>(experiments.size()); ++e) {
    const Experiment& experiment = experiments[static_cast<std::size_t>(e)];
    for (int lap = 0; lap < experiment.laps; ++lap, ++at) {
      if (at < sorted.size() && sorted[at].experiment == e && sorted[at].lap == lap) continue;
      throw IoError(table.string(), 0,
                    "lap " + std::to_string(lap) + " of " + experiment.label() + ", " + experiment.scenario +
                        ": is missing; rename the file to " + journal_name + " to continue the evaluation");
    }
  }
}

/// Whether both the settings and the laps have checksums. Throws IoError where only the laps have them.
bool all_checked(const fs::path& settings, bool settings_checked, bool laps_checked, bool has_laps) {
  if (laps_checked && !settings_checked && has_laps)
    throw IoError(settings.string(), 0, "has no checksum, but the laps have: it is damaged or was replaced");
  return laps_checked && settings_checked;
}

}  // namespace

std::string with_checksum(const std::string& settings) {
  Json json = parse_json(settings);
  json.erase(checksum_key);
  json[checksum_key] = checksum_of(json);
  return json_text(json, 2);
}

bool verify_checksum(const std::string& stored_settings) {
  Json json = parse_json(stored_settings);
  if (!json.is_object()) throw std::invalid_argument("is not a JSON object");
  if (!json.contains(checksum_key)) return false;
  const Json stored = json.at(checksum_key);
  json.erase(checksum_key);
  if (stored != checksum_of(json))
    throw std::invalid_argument(
        "key checksum: is not that of the settings: the file is damaged or was edited");
  return true;
}

LapStore::LapStore(const fs::path& folder, const Evaluation& evaluation, bool resume)
    : folder_(folder), experiments_(evaluation.experiments) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string(), 0, "cannot create the folder: " + error.message());
  lock_ = std::make_unique<FolderLock>(folder);
  const fs::path settings = folder / settings_name, journal = folder / journal_name,
                 table = folder / table_name;
  std::string settings_to_write;
  bool settings_checked = true;
  const bool has_laps = fs::exists(journal) || fs::exists(table);
  if (has_laps && !resume) {
    throw IoError(folder.string(), 0,
                  "contains the laps of an evaluation: give --resume to continue it, or another folder");
  }
  if (has_laps && !fs::exists(settings))
    throw IoError(settings.string(), 0, "is missing, but the folder contains laps");
  if (has_laps) {
    const auto [stored_build, checked] = check_settings(settings, evaluation.settings);
    settings_checked = checked;
    const bool same = stored_build.ends_with(evaluation.build);
    if (!same && !fs::exists(table)) check_build(evaluation, stored_build);
    const std::string builds =
        same ? stored_build : (stored_build.empty() ? "unknown" : stored_build) + " " + evaluation.build;
    if (!fs::exists(table) && !(same && checked)) settings_to_write = with_build(evaluation.settings, builds);
  } else {
    replace_file(settings, with_build(evaluation.settings, evaluation.build));
  }
  if (fs::exists(table)) {
    rows_ = read_rows(table, experiments_, false, evaluation.seed0, &checked_);
    std::sort(rows_.begin(), rows_.end(), is_table_order);
    check_complete(table, rows_, experiments_);
    checked_ = all_checked(settings, settings_checked, checked_, !rows_.empty());
    return;
  }
  if (fs::exists(journal)) rows_ = read_rows(journal, experiments_, true, evaluation.seed0, &checked_);
  checked_ = all_checked(settings, settings_checked, checked_, !rows_.empty());
  if (!settings_to_write.empty()) replace_file(settings, settings_to_write);
  replace_file(journal, table_text(rows_, experiments_));  // without a truncated line
  journal_ = ::open(journal.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (journal_ < 0) throw_system(journal, "cannot be written");
}

void LapStore::check_build(const Evaluation& evaluation, const std::string& stored_build) const {
  if (evaluation.any_build) return;
  throw IoError((folder_ / settings_name).string(), 0,
                "the laps were driven by another build of the program (build " +
                    (stored_build.empty() ? "unknown" : stored_build) + ", this is " + evaluation.build +
                    "), whose laps may differ. Continue with that build, choose another folder, or give "
                    "--any-build to mix them");
}

LapStore::~LapStore() {
  if (journal_ >= 0) ::close(journal_);
}

void LapStore::add(const LapRow& row) {
  write_all(journal_, checked_line(csv_line(row, experiments_)) + "\n", folder_ / journal_name);
  rows_.push_back(row);
}

void LapStore::complete() {
  if (journal_ < 0) return;
  std::sort(rows_.begin(), rows_.end(), is_table_order);
  replace_file(folder_ / table_name, table_text(rows_, experiments_));
  ::close(journal_);
  journal_ = -1;
  fs::remove(folder_ / journal_name);
}

}  // namespace slalom::evaluation
