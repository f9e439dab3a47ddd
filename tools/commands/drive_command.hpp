#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// Registers `slalom drive`, which drives laps. Its callback sets `exit_status`: 0 only if all laps were
/// finished; what fails throws.
CLI::App* add_drive_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
