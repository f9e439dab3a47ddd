#pragma once

namespace CLI {
class App;
}

namespace slalom::tools {

/// `slalom tune`: searches options over paired seeds.
CLI::App* add_tune_command(CLI::App& app, int& exit_status);

}  // namespace slalom::tools
