#pragma once

#include <string>

namespace slalom::tools {

/// Names the machine code of this program and of Slalom's shared libraries, if any: their GNU build ids,
/// shortened. Two programs of the same sources and compiler have the same; "unknown" where there is none.
std::string build_id();

/// Names the processor as /proc/cpuinfo does, or "unknown".
std::string processor_name();

}  // namespace slalom::tools
