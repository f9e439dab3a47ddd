#include "slalom/core/options.hpp"

#include <sstream>

#include "slalom/core/option_access.hpp"

namespace slalom::detail {

void throw_out_of_range(std::string_view where, const Declaration& d, double value) {
  std::string option(where);
  if (!option.empty()) option += ".";
  throw std::invalid_argument(option + d.name + ": " + to_text(value) + " " + range_rule(d));
}

void throw_wrong_count(std::string_view where, const Declaration& d, std::size_t count, int inputs) {
  std::ostringstream message;
  message << where << (where.empty() ? "" : ".") << d.name << ": has " << count << " values, must have one";
  if (inputs != 1) message << " for all inputs";
  if (inputs > 1) message << ", or one for each of the " << inputs;
  throw std::invalid_argument(message.str());
}

}  // namespace slalom::detail
