#include "tools/terminal/thread_note.hpp"

#include <cstdio>

namespace slalom::tools {

void note_fewer_threads(const char* option, int wanted, int started) {
  if (started >= wanted) return;
  std::fprintf(stderr, "%s %d: the system could start %d thread%s only; the results are the same\n", option,
               wanted, started, started == 1 ? "" : "s");
}

}  // namespace slalom::tools
