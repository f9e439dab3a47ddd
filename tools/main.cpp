// The program slalom, with its commands in alphabetical order.
#include "tools/commands/commands.hpp"
#include "tools/terminal/interrupt.hpp"

int main(int argc, char** argv) {
  using namespace slalom::tools;
  return exit_status(run_command_line(argc, argv,
                                      {{"bench", declare_bench},
                                       {"compare", declare_compare},
                                       {"course", declare_course},
                                       {"drive", declare_drive},
                                       {"eval", declare_eval},
                                       {"explain", declare_explain},
                                       {"export", declare_export},
                                       {"identify", declare_identify},
                                       {"navigate", declare_navigate},
                                       {"options", declare_options},
                                       {"race", declare_race},
                                       {"racing-benchmark", declare_racing_benchmark},
                                       {"replay", declare_replay},
                                       {"reproduce", declare_reproduce},
                                       {"track", declare_track},
                                       {"tune", declare_tune},
                                       {"view", declare_view}}));
}
