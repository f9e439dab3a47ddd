#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom track`, which makes a course folder. Its callback sets `exit_status`; what fails throws.
CLI::App* add_track_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
