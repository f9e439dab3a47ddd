#pragma once

namespace slalom {

/// The version of the library, "major.minor.patch".
const char* version() noexcept;

}  // namespace slalom
