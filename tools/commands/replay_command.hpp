#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom replay`: a lap of an evaluation driven again, to look at.
CLI::App* add_replay_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
