#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom options`, which lists what can be set. Its callback sets `exit_status`; what fails
/// throws.
CLI::App* add_options_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
