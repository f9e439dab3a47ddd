#pragma once

#include <atomic>
#include <cstdint>

#include "view/server/server.hpp"

namespace slalom::view {

/// `ServerCounters` that one thread may read while another one counts.
struct AtomicCounters {
  std::atomic<std::uint64_t> connections{0}, messages{0}, frames_sent{0}, frames_dropped{0},
      refused_origin{0}, refused_token{0}, refused_size{0}, refused_rate{0}, refused_other{0};

  ServerCounters snapshot() const {
    return {connections,   messages,     frames_sent,  frames_dropped, refused_origin,
            refused_token, refused_size, refused_rate, refused_other};
  }
};

}  // namespace slalom::view
