#pragma once

namespace slalom::tools {

/// Says on standard error if the system could start only `started` of the `wanted` threads that `option`
/// asks for. The results do not depend on their number.
void note_fewer_threads(const char* option, int wanted, int started);

}  // namespace slalom::tools
