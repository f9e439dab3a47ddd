#include "vehicle/course/course_readers.hpp"

#include <algorithm>
#include <charconv>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/maps/yaml_text.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr std::uint64_t max_bytes = std::uint64_t{1} << 26;
constexpr int raceline_columns = 7;
const char* const raceline_header = "s_m;x_m;y_m;psi_rad;kappa_radpm;vx_mps;ax_mps2";

std::string_view trimmed(std::string_view text) {
  const char* const blanks = " \t\r\n\f\v";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const auto end = line.find(separator);
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

struct Line {
  int number = 0;
  std::string text;  ///< without blanks at either end, never empty
};

std::vector<Line> read_lines(const std::filesystem::path& file) {
  const std::string text = read_file(file, max_bytes);
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  std::vector<Line> lines;
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = std::min(rest.find('\n'), rest.size());
    if (const auto content = trimmed(rest.substr(0, end)); !content.empty())
      lines.push_back({number, std::string(content)});
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return lines;
}

std::string without_blanks(std::string_view text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t') result += c;
  return result;
}

/// The present row of a table of numbers, with file, line and column names for messages.
struct Row {
  const std::filesystem::path& file;
  const Line& line;
  const std::vector<std::string_view>& cells;

  double number(std::size_t column, std::string_view column_name) const {
    const auto value = maps::finite_number(cells[column]);
    if (!value)
      throw IoError(file.string(), line.number,
                    "column " + std::string(column_name) + ": '" + std::string(cells[column]) +
                        "' must be a finite number");
    return *value;
  }

  maps::Point point(std::size_t x, const char* x_name, std::size_t y, const char* y_name) const {
    const maps::Point point{number(x, x_name), number(y, y_name)};
    if (!maps::is_plausible(point))
      throw IoError(file.string(), line.number,
                    std::string("columns ") + x_name + " and " + y_name + ": '" + std::string(cells[x]) +
                        "', '" + std::string(cells[y]) + "' must be within 1e7 m of 0");
    return point;
  }
};

/// The columns of a waypoint's x, y and speed.
struct Columns {
  char separator = ',';
  std::size_t count = 0, x = 0, y = 1, speed = 0;
  const char *x_name = "opt_x", *y_name = "opt_y", *speed_name = "ref_v";
};

Columns optimised_line_columns(const std::filesystem::path& file, const Line& header) {
  const auto names = split(header.text, ',');
  const auto speed = std::find(names.begin(), names.end(), "ref_v");
  if (speed == names.end())
    throw IoError(file.string(), header.number,
                  "column ref_v: missing in '" + header.text + "'; the header must be opt_x,opt_y,...,ref_v");
  for (const char* name : {"opt_x", "opt_y", "ref_v"})
    if (std::count(names.begin(), names.end(), name) > 1)
      throw IoError(file.string(), header.number,
                    "column " + std::string(name) + ": occurs twice in '" + header.text + "'");
  return {.count = names.size(), .speed = static_cast<std::size_t>(speed - names.begin())};
}

bool is_comment(const Line& line) {
  return line.text.front() == '#';
}

char separator_of(const Line& line) {
  return line.text.find(';') != std::string::npos ? ';' : ',';
}

/// Whether a line has names in place of numbers.
bool is_header(const Line& line) {
  const std::string_view cell = split(line.text, separator_of(line))[0];
  double value = 0;
  return is_comment(line) || std::from_chars(cell.data(), cell.data() + cell.size(), value).ec != std::errc{};
}

/// Whether a header names x, y and a speed, and nothing else.
bool names_speed(const Line& line) {
  const std::string text = without_blanks(is_comment(line) ? line.text.substr(1) : line.text);
  const auto names = split(text, separator_of(line));
  return names.size() == 3 && names[0].starts_with('x') && names[1].starts_with('y') &&
         (names[2].starts_with('v') || names[2].starts_with("speed"));
}

}  // namespace

CsvForm csv_form(const std::filesystem::path& file) {
  for (const Line& line : read_lines(file)) {
    if (names_speed(line)) return CsvForm::points_with_speed;
    if (is_comment(line)) {
      if (without_blanks(line.text.substr(1)) == raceline_header) return CsvForm::raceline;
      if (without_blanks(line.text) == without_blanks(centre_line_header)) return CsvForm::centre_line;
      continue;
    }
    const auto cells = split(line.text, ',');
    if (cells.size() >= 2 && cells[0] == "opt_x" && cells[1] == "opt_y") return CsvForm::optimised_line;
    return split(line.text, ';').size() == raceline_columns ? CsvForm::raceline : CsvForm::other;
  }
  return CsvForm::other;
}

std::vector<Waypoint> read_waypoints(const std::filesystem::path& file, CsvForm form,
                                     std::vector<int>& lines) {
  const auto content = read_lines(file);
  std::size_t first = 0;
  while (first < content.size() && is_comment(content[first])) ++first;
  const bool plain = form == CsvForm::points_with_speed;
  while (plain && first < content.size() && is_header(content[first])) ++first;
  const Columns columns =
      form == CsvForm::optimised_line ? optimised_line_columns(file, content[first++])
      : plain
          ? Columns{first < content.size() ? separator_of(content[first]) : ';', 3, 0, 1, 2, "x", "y", "v"}
          : Columns{';', raceline_columns, 1, 2, 5, "x_m", "y_m", "vx_mps"};
  std::vector<Waypoint> waypoints;
  lines.clear();
  for (; first < content.size(); ++first) {
    const Line& line = content[first];
    const auto cells = split(line.text, columns.separator);
    if (cells.size() != columns.count)
      throw IoError(file.string(), line.number,
                    std::to_string(cells.size()) + " columns; every row must have " +
                        std::to_string(columns.count) + ", separated by '" + columns.separator + "'");
    const Row row{file, line, cells};
    const auto [x, y] = row.point(columns.x, columns.x_name, columns.y, columns.y_name);
    const Waypoint waypoint{.x = x, .y = y, .speed = row.number(columns.speed, columns.speed_name)};
    if (waypoint.speed < 0)
      throw IoError(file.string(), line.number,
                    "column " + std::string(columns.speed_name) + ": " + std::string(cells[columns.speed]) +
                        " must be at least 0");
    waypoints.push_back(waypoint);
    lines.push_back(line.number);
  }
  const auto drives = [](const Waypoint& waypoint) { return waypoint.speed > 0; };
  if (!waypoints.empty() && std::none_of(waypoints.begin(), waypoints.end(), drives))
    throw IoError(
        file.string(), lines.front(),
        "column " + std::string(columns.speed_name) + ": 0 in every row; at least one must be above 0");
  return waypoints;
}

std::vector<CentreLineRow> read_centre_line_rows(const std::filesystem::path& file, bool& widths) {
  std::vector<CentreLineRow> rows;
  bool left_first = false, first = true;
  for (const Line& line : read_lines(file)) {
    const auto cells = split(line.text, separator_of(line));
    if (is_comment(line) || (first && is_header(line))) {
      const auto left = line.text.find("left"), right = line.text.find("right");
      if (left != std::string::npos && right != std::string::npos) left_first = left < right;
      first = is_comment(line) && first;
      continue;
    }
    if (cells.size() < 2)
      throw IoError(
          file.string(), line.number,
          "1 column; every row must have x, y, width to the right, width to the left, or x and y first");
    if (!rows.empty() && widths != (cells.size() >= 4))
      throw IoError(file.string(), line.number,
                    std::to_string(cells.size()) + " columns; every row must have as many as the first");
    widths = cells.size() >= 4;
    first = false;
    const Row row{file, line, cells};
    const auto [x, y] = row.point(0, "x", 1, "y");
    CentreLineRow read{line.number, x, y, 0, 0};
    if (widths) {
      const double third = row.number(2, "3 (width)"), fourth = row.number(3, "4 (width)");
      if (third < 0 || fourth < 0 || std::max(third, fourth) > maps::PoseLimits::position)
        throw IoError(file.string(), line.number, "columns 3 and 4 (widths): must be within 0 to 1e7 m");
      read.left = left_first ? third : fourth;
      read.right = left_first ? fourth : third;
    }
    rows.push_back(read);
  }
  return rows;
}

std::vector<maps::Point> read_points(const std::filesystem::path& file) {
  std::vector<maps::Point> points;
  for (const Line& line : read_lines(file)) {
    const auto cells = split(line.text, ',');
    if (cells.size() < 2)
      throw IoError(file.string(), line.number,
                    "1 column; every row must have x and y first, separated by ','");
    const Row row{file, line, cells};
    points.push_back(row.point(0, "0 (x)", 1, "1 (y)"));
  }
  if (points.empty()) throw IoError(file.string(), 0, "must have at least one point");
  return points;
}

}  // namespace slalom::vehicle::detail
