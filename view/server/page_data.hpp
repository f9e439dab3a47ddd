#pragma once

#include <string>

namespace slalom::view {

/// The page, compressed with gzip.
std::string page_gzip();

}  // namespace slalom::view
