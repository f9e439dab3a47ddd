#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom view`, which drives and serves a page that shows it. Its callback sets `exit_status`;
/// what fails throws.
CLI::App* add_view_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
