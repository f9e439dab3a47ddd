#include "tools/recording/replay_recording.hpp"

#include <chrono>
#include <cstdio>
#include <fstream>

#include "slalom/core/error.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/terminal/interrupt.hpp"
#include "view/embedded.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/replay.hpp"
#include "view/server/server.hpp"

namespace slalom::tools {

int replay_recording(const ReplayArguments& arguments) {
  std::uint64_t lost = 0;
  const std::string page =
      view::replay_page(view::gunzip(view::page_gzip()), view::load_replay(arguments.file, &lost));
  if (lost > 0)
    std::fprintf(stderr, "note: %s was cut: its last %llu bytes cannot be read\n", arguments.file.c_str(),
                 static_cast<unsigned long long>(lost));
  if (!arguments.html.empty()) {
    std::ofstream stream(arguments.html, std::ios::binary);
    stream << page;
    stream.close();
    if (!stream) throw IoError(arguments.html, 0, "cannot be written");
    std::printf("replay: %s, opens in any browser\n", arguments.html.c_str());
    return 0;
  }
  view::ServerOptions options = server_options(arguments.host, arguments.port, "");
  view::Server server(options, {{"/", {"text/html; charset=utf-8", page}}});
  const InterruptFlag interrupt;
  print_address(server, options);
  while (!interrupt.raised()) {
    server.wait(std::chrono::milliseconds(100));
    server.take();
  }
  return 0;
}

}  // namespace slalom::tools
