#include "tools/terminal/text_table.hpp"

#include "slalom/evaluation/results.hpp"
#include "tools/command_line/words.hpp"

namespace slalom::tools {

void TextTable::print(std::FILE* out) const {
  const std::vector<std::string>& heads = rows_.front();
  std::vector<int> widths(heads.size());
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < heads.size(); ++i)
      widths[i] = std::max(widths[i], static_cast<int>(row[i].size() - (&row == &heads && row[i][0] == '<')));
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < heads.size(); ++i) {
      const bool words = heads[i][0] == '<';
      const char* const cell = row[i].c_str() + (&row == &heads && words);
      line += formatted(words ? "%s%-*s" : "%s%*s", i == 0 ? "" : "  ", widths[i], cell);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    std::fprintf(out, "%s\n", line.c_str());
  }
}

std::string TextTable::html() const {
  std::string html = "<table>\n";
  for (const auto& row : rows_) {
    const bool is_head = &row == &rows_.front();
    const std::string tag = is_head ? "th" : "td";
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool words = rows_.front()[i][0] == '<';
      html += "<" + tag + (words ? " class=\"words\">" : ">") + escaped(row[i].substr(is_head && words)) +
              "</" + tag + ">";
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&'   ? "&amp;"
           : c == '<' ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  return out;
}

std::string number_cell(double value, int digits) {
  return std::isfinite(value) ? formatted("%.*f", digits, value) : "-";
}

std::string mean_cell(double mean, const evaluation::Interval& interval, int laps, int digits) {
  if (!std::isfinite(mean) || laps < evaluation::fewest_laps) return number_cell(mean, digits);
  return formatted("%.*f (%.*f-%.*f)", digits, mean, digits, interval.low, digits, interval.high);
}

std::string rate_cell(const std::optional<double>& rate,
                      const std::optional<evaluation::Interval>& interval) {
  return rate ? formatted("%.1f (%.1f-%.1f)", 100 * *rate, 100 * interval->low, 100 * interval->high) : "-";
}

std::string figure_head(const evaluation::Figure& figure) {
  std::string head = figure.name;
  std::replace(head.begin(), head.end(), '_', ' ');
  return *figure.unit ? head + ", " + figure.unit : head;
}

}  // namespace slalom::tools
