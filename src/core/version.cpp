#include "slalom/core/version.hpp"

namespace slalom {

const char* version() noexcept {
  return SLALOM_VERSION;
}

}  // namespace slalom
