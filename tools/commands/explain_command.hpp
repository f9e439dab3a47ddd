#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom explain`, which shows what methods make of a problem with two ways. Its callback sets
/// `exit_status`; what fails throws.
CLI::App* add_explain_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
