#pragma once

#include <utility>

#include "slalom/core/option_access.hpp"

namespace slalom::nodes {

/// An option of the library under the name of its parameter: "section.option", or "option".
struct NamedOption {
  std::string name;   ///< name of the parameter
  OptionEntry entry;  ///< declaration and present value
};

/// Names and values of options to be changed, as text.
using Changes = std::vector<std::pair<std::string, std::string>>;

}  // namespace slalom::nodes
