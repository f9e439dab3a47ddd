#include "tools/ranks/ranks.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "slalom/core/error.hpp"

#if defined(SLALOM_WITH_MPI)
#include <mpi.h>

#include <chrono>
#include <mutex>
#include <system_error>
#include <thread>
#endif

namespace slalom::tools {
namespace {

/// The number of processes that mpirun started: Open MPI, MPICH, Intel MPI.
int started_processes() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* text = std::getenv(name))
      return static_cast<int>(std::clamp(std::strtol(text, nullptr, 10), 1L, 1L << 20));
  return 1;
}

}  // namespace

#if defined(SLALOM_WITH_MPI)

namespace {

using namespace evaluation;

enum Tag { request, assignment, row, failure, leaving };

/// MPI, begun only under mpirun and ended with the program.
class World {
 public:
  static const World& instance() {
    static const World world;
    return world;
  }
  int rank = 0, count = 1;

 private:
  World() {
    if (started_processes() < 2) return;
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    if (provided < MPI_THREAD_SERIALIZED)
      throw IoError("mpirun", 0, "this MPI library does not support threads");
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
  }
};

void send_text(const std::string& text, int to, Tag tag) {
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, to, tag, MPI_COMM_WORLD);
}

/// The first process as the others see it.
class FirstRank final : public LapQueue {
 public:
  explicit FirstRank(const std::vector<Experiment>& experiments) : experiments_(experiments) {}

  std::optional<LapTask> next() override {
    const std::lock_guard lock(mutex_);
    send_text("", 0, request);
    int task[2];
    MPI_Recv(task, 2, MPI_INT, 0, assignment, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (task[0] < 0) return std::nullopt;
    return LapTask{task[0], task[1]};
  }
  void keep(const LapRow& driven) override {
    const std::lock_guard lock(mutex_);
    send_text(csv_line(driven, experiments_), 0, row);
  }
  void fail(std::exception_ptr error) override {
    const std::lock_guard lock(mutex_);
    try {
      std::rethrow_exception(error);
    } catch (const std::exception& what) {
      send_text(what.what(), 0, failure);
    } catch (...) {
      send_text("a lap failed", 0, failure);
    }
  }

 private:
  const std::vector<Experiment>& experiments_;
  std::mutex mutex_;
};

/// Answers the other processes until all have left.
void serve(const Evaluation& evaluation, EvaluationQueue& work) {
  for (int present = rank_count() - 1; present > 0;) {
    MPI_Status status;
    int there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (!there) {
      std::this_thread::sleep_for(std::chrono::microseconds(500));
      continue;
    }
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string text(static_cast<std::size_t>(size), ' ');
    MPI_Recv(text.data(), size, MPI_CHAR, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    if (status.MPI_TAG == request) {
      const auto task = work.next();
      const int sent[2] = {task ? task->experiment : -1, task ? task->lap : -1};
      MPI_Send(sent, 2, MPI_INT, status.MPI_SOURCE, assignment, MPI_COMM_WORLD);
    } else if (status.MPI_TAG == row) {
      try {
        work.keep(parse_line(text, evaluation.experiments));
      } catch (...) {
        work.fail(std::current_exception());
      }
    } else if (status.MPI_TAG == failure) {
      work.fail(std::make_exception_ptr(std::runtime_error(text)));
    } else {
      --present;
    }
  }
}

}  // namespace

int rank_count() {
  return World::instance().count;
}
int rank() {
  return World::instance().rank;
}

int drive_with_ranks(const Evaluation& evaluation, EvaluationQueue& work, int jobs,
                     const std::atomic<bool>& cancel) {
  if (rank_count() == 1) return drive_laps(evaluation, work, jobs, cancel);
  int threads = 0;
  {
    std::jthread own;  // it is joined even if serve() throws
    try {
      own = std::jthread([&] {
        try {
          threads = drive_laps(evaluation, work, jobs, cancel);
        } catch (...) {
          work.fail(std::current_exception());
        }
      });
    } catch (const std::system_error&) {
      // The system cannot start it. The other processes drive all laps.
    }
    try {
      serve(evaluation, work);
    } catch (...) {
      work.fail(std::current_exception());  // the queue hands out no further lap
      throw;
    }
  }
  MPI_Finalize();
  return threads;
}

void drive_for_first_rank(const Evaluation& evaluation, int jobs, const std::atomic<bool>& cancel) {
  FirstRank first(evaluation.experiments);
  drive_laps(evaluation, first, jobs, cancel);
  send_text("", 0, leaving);
  MPI_Finalize();
}

#else

int rank_count() {
  if (started_processes() > 1)
    throw IoError("mpirun", 0,
                  "this program was built without MPI; install libopenmpi-dev and build it again");
  return 1;
}
int rank() {
  return 0;
}
int drive_with_ranks(const evaluation::Evaluation& evaluation, evaluation::EvaluationQueue& work, int jobs,
                     const std::atomic<bool>& cancel) {
  return drive_laps(evaluation, work, jobs, cancel);
}
void drive_for_first_rank(const evaluation::Evaluation&, int, const std::atomic<bool>&) {}

#endif

}  // namespace slalom::tools
