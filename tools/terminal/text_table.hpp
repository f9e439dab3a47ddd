#pragma once

#include <cstdio>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include "slalom/evaluation/lap_figures.hpp"
#include "slalom/evaluation/statistics.hpp"

/// Tables of the terminal.
namespace slalom::tools {

/// A table whose columns are as wide as their widest cell. Numbers end at the right of their column; words,
/// in the columns whose head begins with '<', begin at its left.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  /// Adds a row with a cell for each column.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  void print(std::FILE* out) const;
  std::string html() const;
  bool empty() const { return rows_.size() < 2; }

 private:
  std::vector<std::vector<std::string>> rows_;  ///< the heads first
};

/// A text as HTML shows it.
std::string escaped(const std::string& text);
/// "12.346"; "-" if it is not finite.
std::string number_cell(double value, int digits = 3);
/// "0.412 (0.398-0.427)", with an interval of 95 %; none below fewest_laps, "-" for what is not a number.
std::string mean_cell(double mean, const evaluation::Interval& interval, int laps, int digits = 3);
/// "12.5 (10.1-15.3)", a rate and its interval in percent; "-" without one.
std::string rate_cell(const std::optional<double>& rate, const std::optional<evaluation::Interval>& interval);
/// The head of a figure: "best lap, s".
std::string figure_head(const evaluation::Figure& figure);

/// The heads of the columns of `visit_figures`, after those of `first`. Lists of numbers have no column.
template <class Figures>
std::vector<std::string> figure_heads(std::vector<std::string> first, const Figures& figures) {
  visit_figures(figures, [&](const auto& value, const evaluation::Figure& figure) {
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>)
      first.push_back(figure_head(figure));
  });
  return first;
}
/// The cells below them.
template <class Figures>
std::vector<std::string> figure_cells(std::vector<std::string> first, const Figures& figures) {
  visit_figures(figures, [&](const auto& value, const evaluation::Figure&) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_integral_v<Value>)
      first.push_back(std::to_string(value));
    else if constexpr (std::is_floating_point_v<Value>)
      first.push_back(number_cell(value));
  });
  return first;
}

}  // namespace slalom::tools
