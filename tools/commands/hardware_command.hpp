#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom hardware`: laps under the conditions of a real car, beside the published figures of one.
CLI::App* add_hardware_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
