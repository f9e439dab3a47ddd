#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom reproduce`: the paper's simulation section beside the authors' figures.
CLI::App* add_reproduce_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
