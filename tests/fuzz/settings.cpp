// Folders of evaluations: settings.json, and JSON itself. The checksum of the settings is made right before
// they are read, as a fuzzer does not find it.
#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "tools/evaluation/stored_evaluation.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  const Json settings = {
      {"course", "wren"},
      {"course_hash", "0123456789abcdef"},
      {"config", "default"},
      {"evaluation", "true"},
      {"latency_ms", 0.5},
      {"seed0", 3},
      {"experiments", Json::array({{{"method", "mppi"},
                                    {"set", "mppi.samples=32 mppi.variance=[0.1;0.2]"},
                                    {"scenario", "oa"},
                                    {"obstacles", 5},
                                    {"laps", 2}}})},
      {"options", {{"mppi", {{"samples", 32}, {"variance", Json::array({0.1, 0.2})}, {"shape", "narrow"}}}}}};
  return {settings.dump(), settings.dump(2),
          R"([1,-2.5e-3,18446744073709551615,null,true,"\u00e9",{"a":{}}])"};
}

void check_json(std::string_view bytes) {
  const Json json = parse_json_or_null(bytes);
  const std::string text = json_text(json);
  require(json_text(parse_json(text)) == text, "JSON that is written reads back as the same");
  json.flatten();
}

bool load(const std::string& folder) {
  try {
    const tools::StoredEvaluation stored = tools::load_evaluation(folder);
    require(!stored.experiments.empty(), "an evaluation has experiments");
    for (const evaluation::Experiment& each : stored.experiments)
      require(each.laps >= 1 && each.obstacles >= 0, "an experiment has laps");
    tools::evaluation_arguments(stored, "");
    return true;
  } catch (const IoError&) {
    return false;
  }
}

/// Continues an evaluation whose settings are those stored.
void resume(const std::string& folder, const std::string& settings) {
  evaluation::Evaluation wanted;
  wanted.settings = settings;
  wanted.experiments = {{"mppi", {}, "oa", 5, 2}};
  try {
    const evaluation::LapStore store(folder, wanted, true);
    require(store.rows().empty(), "there were no laps");
  } catch (const IoError&) {
  }
}

bool run(std::string_view bytes) {
  check_json(bytes);
  scratch_file("laps.csv", evaluation::checked_header() + "\n");
  const std::string text(bytes);
  const bool is_object = parse_json_or_null(bytes).is_object();
  scratch_file("settings.json", is_object ? evaluation::with_checksum(text) : text);
  const bool valid = load(scratch_folder());
  scratch_file("laps.journal.csv", evaluation::checked_header() + "\n");
  resume(scratch_folder(), is_object ? text : "{}");
  return valid;
}

const Target target("settings", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
