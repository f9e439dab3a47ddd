// Options as text, as `--set key=value` and the page give them: one a line.
#include "fuzz/target.hpp"
#include "tools/command_line/command.hpp"
#include "tools/scenario/scenario.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  std::vector<std::string> seeds{
      "samples=100\nsvg_mppi.variance=[0.1]\nworld.friction=0.5\nplanner.max_speed=8\n"};
  for (const vehicle::Section& section : vehicle::list_sections({})) {
    std::string all;
    for (const OptionEntry& option : section.options)
      all += section.name + "." + option.declaration.name + "=" + to_text(option.value) + "\n";
    seeds.push_back(all);
  }
  return seeds;
}

/// The values of all options are within their declared ranges.
void check_ranges(const vehicle::Configuration& configuration) {
  for (const vehicle::Section& section : vehicle::list_sections(configuration))
    for (const OptionEntry& option : section.options) {
      const auto check = [&](double value) {
        require(
            value >= option.declaration.min && value <= option.declaration.max,
            section.name + "." + option.declaration.name + ": " + to_text(option.value) + " is out of range");
      };
      if (const auto* integer = std::get_if<int>(&option.value)) check(*integer);
      if (const auto* number = std::get_if<double>(&option.value)) check(*number);
      if (const auto* numbers = std::get_if<std::vector<double>>(&option.value))
        for (const double number : *numbers) check(number);
    }
}

bool run(std::string_view bytes) {
  bool valid = true;
  vehicle::Configuration configuration;
  evaluation::LapSettings lap;
  while (!bytes.empty()) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    bytes.remove_prefix(std::min(bytes.size(), line.size() + 1));
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    try {
      tools::apply_setting(std::string(line.substr(0, equals)), std::string(line.substr(equals + 1)),
                           "svg_mppi", configuration, lap);
    } catch (const tools::CommandLineError&) {
      valid = false;
    }
  }
  check_ranges(configuration);
  validate_options(lap, "world");
  return valid;
}

const Target target("options", 4096, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
