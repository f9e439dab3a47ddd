#include <memory>

#include "tools/commands/commands.hpp"

namespace slalom::tools {
namespace {

struct ExplainArguments {
  int figure = 0;  ///< 0: not given
  std::string plot;
  std::uint64_t seed = 0;
};

}  // namespace

void declare_explain(Subcommand& command) {
  command.summary(
      "Draw a figure of the SVG-MPPI paper: how methods solve a problem with two equally good ways, by the "
      "Python package and matplotlib");
  const auto arguments = std::make_shared<ExplainArguments>();
  command.option("--figure", arguments->figure, "Figure of the paper: 1, 3 or 4",
                 {.least = 1, .most = 4, .required = true});
  command.option("--plot", arguments->plot, "Write the figure to this PNG, SVG or PDF", {.required = true});
  command.option("--seed", arguments->seed, "Seed of the random numbers");
  command.examples({"explain --figure 4 --plot figure.png"});
  command.action([arguments] {
    if (arguments->figure == 2) throw CommandLineError("--figure", "'2' must be 1, 3 or 4");
    become_python("paper_figures");
    return 0;
  });
}

}  // namespace slalom::tools
