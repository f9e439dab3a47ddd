#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom identify`: steering gain, trim, delay, lag and wheelbase of a car from a recording.
CLI::App* add_identify_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
