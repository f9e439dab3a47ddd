#include "tools/evaluation/evaluation_check.hpp"

#include <algorithm>
#include <cstdio>

#include "slalom/core/error.hpp"
#include "tools/evaluation/stored_evaluation.hpp"

namespace slalom::tools {

int check_evaluation(const std::filesystem::path& folder, int again) {
  const StoredEvaluation stored = load_evaluation(folder);
  std::size_t laps = 0;
  for (const auto& e : stored.experiments) laps += static_cast<std::size_t>(e.laps);
  std::printf("%zu of %zu laps: seeds as expected, checksums correct\n", stored.rows.size(), laps);
  if (stored.rows.size() != laps)
    throw IoError(folder.string(), 0,
                  std::to_string(laps - stored.rows.size()) + " laps are missing: continue it with --resume");
  Scenario scenario;
  const evaluation::Evaluation evaluation = rebuild_evaluation(stored, "", scenario);
  const auto repeats = std::min(laps, static_cast<std::size_t>(again));
  std::size_t same = 0;
  for (std::size_t i = 0; i < repeats; ++i) {
    const evaluation::LapRow& kept = stored.rows[repeats == 1 ? 0 : i * (laps - 1) / (repeats - 1)];
    const auto result = run_lap(lap_setup(evaluation, kept.experiment), kept.seed);
    const bool equal = same_lap(make_row(kept.experiment, kept.lap, result, 0), kept, stored.experiments);
    same += equal;
    if (!equal)
      std::printf(
          "lap %d of %s is NOT identical: it was changed, or another version or instruction set drove it\n",
          kept.lap, stored.experiments[static_cast<std::size_t>(kept.experiment)].label().c_str());
  }
  std::printf("%zu of %zu laps driven again are identical, bit for bit\n", same, repeats);
  return same == repeats ? 0 : 1;
}

}  // namespace slalom::tools
