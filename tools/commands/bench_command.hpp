#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom bench`, which measures the speed of everything on this machine. Its callback sets
/// `exit_status`; what fails throws.
CLI::App* add_bench_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
