#include "slalom/core/options.hpp"

#include <sstream>

namespace slalom::detail {

void throw_wrong_count(std::string_view where, const Declaration& d, std::size_t count, int inputs) {
  std::ostringstream message;
  message << where << (where.empty() ? "" : ".") << d.name << ": has " << count << " values, must have one";
  if (d.any_count) {
    message << " or more";
  } else {
    if (inputs != 1) message << " for all inputs";
    if (inputs > 1) message << ", or one for each of the " << inputs;
  }
  throw std::invalid_argument(message.str());
}

}  // namespace slalom::detail
