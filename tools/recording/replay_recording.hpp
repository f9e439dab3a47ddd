#pragma once

#include <cstdint>
#include <string>

namespace slalom::tools {

struct ReplayArguments {
  std::string file;  ///< a recording in MCAP
  std::string html;  ///< write the page with the replay inside to this file instead of serving it
  std::string host = "127.0.0.1";
  std::uint16_t port = 8400;
};

/// Serves a recording in the live view's page until it is interrupted, or writes it as a file.
/// Throws IoError.
int replay_recording(const ReplayArguments& arguments);

}  // namespace slalom::tools
