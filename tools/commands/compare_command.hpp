#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom compare`: two evaluations side by side, with tests.
CLI::App* add_compare_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
