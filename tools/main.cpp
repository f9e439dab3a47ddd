// The slalom program: one sub-command per job.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <new>

#include "slalom/core/dispatch.hpp"
#include "slalom/core/version.hpp"
#include "tools/commands/bench_command.hpp"
#include "tools/commands/compare_command.hpp"
#include "tools/commands/drive_command.hpp"
#include "tools/commands/eval_command.hpp"
#include "tools/commands/explain_command.hpp"
#include "tools/commands/hardware_command.hpp"
#include "tools/commands/identify_command.hpp"
#include "tools/commands/options_command.hpp"
#include "tools/commands/replay_command.hpp"
#include "tools/commands/reproduce_command.hpp"
#include "tools/commands/track_command.hpp"
#include "tools/commands/tune_command.hpp"
#include "tools/commands/view_command.hpp"
#include "tools/evaluation/ranks.hpp"
#include "tools/terminal/command_line.hpp"

namespace {

int run(int argc, char** argv) {
  int exit_status = 0;
  CLI::App app{
      "Slalom: sampling-based stochastic optimal control that commits to one good way round an obstacle",
      "slalom"};
  app.set_version_flag("--version", std::string("slalom ") + slalom::version());
  app.require_subcommand(1);
  slalom::tools::add_bench_command(app, exit_status);
  slalom::tools::add_compare_command(app, exit_status);
  slalom::tools::add_drive_command(app, exit_status);
  slalom::tools::add_eval_command(app, exit_status);
  slalom::tools::add_explain_command(app, exit_status);
  slalom::tools::add_hardware_command(app, exit_status);
  slalom::tools::add_identify_command(app, exit_status);
  slalom::tools::add_options_command(app, exit_status);
  slalom::tools::add_replay_command(app, exit_status);
  slalom::tools::add_reproduce_command(app, exit_status);
  slalom::tools::add_track_command(app, exit_status);
  slalom::tools::add_tune_command(app, exit_status);
  slalom::tools::add_view_command(app, exit_status);
  app.parse_complete_callback([&app] {
    for (const CLI::App* command : app.get_subcommands()) slalom::tools::check_command_line(*command);
    // Solvers ask where nothing can be thrown; a SLALOM_TARGET that makes no sense is refused here.
    slalom::simd::active_target();
  });
  // Under mpirun all processes stumble over the same thing.
  const auto complain = [](const char* what) {
    if (slalom::tools::rank() == 0) std::cerr << "slalom: " << what << "\n";
    return 1;
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status == 0 ? 0 : 2;
  } catch (const std::bad_alloc&) {
    return complain("there is not enough memory for so many samples or so long a horizon");
  } catch (const std::exception& error) {
    return complain(error.what());
  }
  return exit_status;
}

}  // namespace

int main(int argc, char** argv) {
  return slalom::tools::after_output(run(argc, argv));
}
