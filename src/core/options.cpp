#include "slalom/core/options.hpp"

#include <cmath>
#include <sstream>

namespace slalom::detail {

void throw_out_of_range(std::string_view where, const Declaration& d, double value) {
  std::ostringstream message;
  message << where << (where.empty() ? "" : ".") << d.name << ": " << value << " must be ";
  if (std::isinf(d.max) && std::isinf(d.min)) {
    message << "a number";
  } else if (std::isinf(d.max)) {
    message << "at least " << d.min;
  } else if (std::isinf(d.min)) {
    message << "at most " << d.max;
  } else {
    message << "in [" << d.min << ", " << d.max << "]";
  }
  throw std::invalid_argument(message.str());
}

void throw_wrong_count(std::string_view where, const Declaration& d, std::size_t count, int inputs) {
  std::ostringstream message;
  message << where << (where.empty() ? "" : ".") << d.name << ": has " << count << " values, must have one";
  if (inputs != 1) message << " for all inputs";
  if (inputs > 1) message << ", or one for each of the " << inputs;
  throw std::invalid_argument(message.str());
}

}  // namespace slalom::detail
