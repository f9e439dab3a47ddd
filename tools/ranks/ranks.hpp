#pragma once

#include <atomic>

#include "slalom/evaluation/evaluation.hpp"

/// The processes that mpirun started, if it did: the first ("rank 0") has the folder, the progress and the
/// summary, the others drive laps for it.
namespace slalom::tools {

/// 1 without mpirun. Throws IoError under mpirun if this program was built without MPI.
int rank_count();
int rank();

/// In the first process: drives laps on `jobs` threads of its own and hands laps to the other processes,
/// until there are none left. Returns how many threads of its own worked; 0 under mpirun if none could start.
int drive_with_ranks(const evaluation::Evaluation& evaluation, evaluation::EvaluationQueue& work, int jobs,
                     const std::atomic<bool>& cancel);

/// In every other process: drives laps on `jobs` threads until the first has none left.
void drive_for_first_rank(const evaluation::Evaluation& evaluation, int jobs,
                          const std::atomic<bool>& cancel);

}  // namespace slalom::tools
