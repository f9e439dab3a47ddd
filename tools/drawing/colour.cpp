#include "tools/drawing/colour.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace slalom::tools {

Colour method_colour(std::string_view name) {
  static constexpr std::pair<std::string_view, Colour> methods[] = {
      {"svg_mppi", {0.12, 0.42, 0.78}}, {"mppi", {0.91, 0.45, 0.10}},   {"reverse_mppi", {0.20, 0.60, 0.36}},
      {"sv_mpc", {0.70, 0.25, 0.55}},   {"cem", {0.55, 0.42, 0.20}},    {"icem", {0.35, 0.35, 0.40}},
      {"dial_mpc", {0.10, 0.60, 0.65}}, {"generic", {0.82, 0.20, 0.22}}};
  const std::string_view word = name.substr(0, name.find_first_of(" ,"));
  std::size_t sum = 0;
  for (const char c : word) sum += static_cast<unsigned char>(c);
  for (const auto& [method, colour] : methods)
    if (method == word) return colour;
  return methods[sum % std::size(methods)].second;
}

Colour mixed(Colour a, Colour b, double share) {
  return {a.red + share * (b.red - a.red), a.green + share * (b.green - a.green),
          a.blue + share * (b.blue - a.blue), a.opacity + share * (b.opacity - a.opacity)};
}

Colour scale_colour(std::span<const Colour> stops, double value) {
  const double at = std::clamp(value, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mixed(stops[i], stops[i + 1], at - static_cast<double>(i));
}

}  // namespace slalom::tools
