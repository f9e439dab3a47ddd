// Counts the instructions of the rollouts of the reference workload, one by one: a child process evaluates a
// batch, and its parent lets it run from one instruction to the next. Counts do not depend on the load of the
// machine and need no performance counters. Prints "address count" for each instruction that ran, relative to
// the program's file; script/instructions-per-step makes a table of them.
//   slalom_instructions_bench reference|published|single_track avx512|avx2|sse4|generic|neon
// With "attached" as a third argument, it evaluates the batch in its own process, between two signals for a
// debugger that counts (an emulator has no single steps of its own), and prints the address of the program's
// file.

#include <elf.h>
#include <link.h>
#include <sys/ptrace.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "slalom/vehicle/model/registry.hpp"

namespace slalom::workload {
namespace {

constexpr int samples = 64, steps = ReferenceWorkload::steps;

vehicle::VehicleOptions problem_of(const std::string& name) {
  if (name == "reference" || name == "published") return reference_problem(name == "published");
  vehicle::VehicleOptions options;
  options.model = vehicle::vehicle_model(name);
  return options;
}

simd::Target target_of(const std::string& wanted) {
  for (const simd::Target target :
       {simd::Target::generic, simd::Target::sse4, simd::Target::avx2, simd::Target::avx512}) {
    if (wanted == simd::name(target) && simd::supported(target)) return target;
  }
  throw std::invalid_argument(wanted + ": not an instruction set of this processor");
}

/// Evaluates the batch between two signals to the process that counts, and ends this one.
[[noreturn]] void evaluate(const BatchEvaluator& evaluator, const SequenceBatch& batch) {
  AlignedBuffer costs(static_cast<std::size_t>(batch.stride()));
  std::vector<std::uint8_t> collided(static_cast<std::size_t>(batch.stride()));
  raise(SIGUSR1);
  evaluator.evaluate(batch, 0, samples, costs.data(), collided.data());
  raise(SIGUSR1);
  _exit(costs[0] > 0 ? 0 : 1);
}

/// Where the next instruction of a stopped process is.
std::uint64_t program_counter(pid_t process) {
  user_regs_struct registers{};
  iovec place{&registers, sizeof registers};
  ptrace(PTRACE_GETREGSET, process, NT_PRSTATUS, &place);
#if defined(__aarch64__)
  return registers.pc;
#else
  return registers.rip;
#endif
}

/// How often each instruction of the program's file ran.
std::map<std::uint64_t, long> count(pid_t child, std::uint64_t base) {
  std::map<std::uint64_t, long> counts;
  int status = 0;
  waitpid(child, &status, 0);
  for (;;) {
    ++counts[program_counter(child) - base];
    if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0)
      throw std::runtime_error("the child process cannot be run step by step");
    waitpid(child, &status, 0);
    if (!WIFSTOPPED(status) || WSTOPSIG(status) != SIGTRAP) break;
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return counts;
}

int run(const std::string& problem, const std::string& target, bool attached) {
  const ReferenceWorkload workload;
  const auto model = workload.model(problem_of(problem), target_of(target));
  const SequenceBatch batch = workload.sequences(samples, steps, model->inputs());
  std::uint64_t base = 0;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* to) {
        *static_cast<std::uint64_t*>(to) = info->dlpi_addr;
        return 1;  // the program is the first
      },
      &base);
  std::printf("rollout steps %d\n", samples * steps);
  if (attached) {
    std::printf("loaded at %llx\n", static_cast<unsigned long long>(base));
    std::fflush(stdout);
    evaluate(model->evaluator(), batch);
  }
  std::fflush(stdout);  // or the child would print it again
  const pid_t child = fork();
  if (child == 0) {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    evaluate(model->evaluator(), batch);
  }
  for (const auto& [address, times] : count(child, base))
    std::printf("%llx %ld\n", static_cast<unsigned long long>(address), times);
  return 0;
}

}  // namespace
}  // namespace slalom::workload

int main(int count, char** arguments) try {
  const bool attached = count == 4 && std::string(arguments[3]) == "attached";
  if (count != 3 && !attached)
    throw std::invalid_argument("usage: slalom_instructions_bench PROBLEM INSTRUCTION_SET [attached]");
  return slalom::workload::run(arguments[1], arguments[2], attached);
} catch (const std::exception& error) {
  std::fprintf(stderr, "slalom_instructions_bench: %s\n", error.what());
  return 1;
}
