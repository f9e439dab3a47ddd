#pragma once

#include <cstdio>
#include <filesystem>

#include "view/embedded.hpp"
#include "view/recording/replay.hpp"

namespace slalom::tools {

/// The page of the live view with a recording inside. Notes on standard error how many bytes of a recording
/// that was cut are lost. Throws IoError.
inline std::string page_of_recording(const std::filesystem::path& recording) {
  std::uint64_t lost = 0;
  const auto segments = view::load_replay(recording.string(), &lost);
  if (lost > 0)
    std::fprintf(stderr, "note: %s was cut: its last %llu bytes cannot be read\n", recording.c_str(),
                 static_cast<unsigned long long>(lost));
  return view::replay_page(view::page_html(), segments);
}

}  // namespace slalom::tools
