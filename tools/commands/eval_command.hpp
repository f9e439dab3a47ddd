#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Adds `slalom eval`: methods compared over many laps, with intervals and paired tests.
CLI::App* add_eval_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
