#pragma once

#include <algorithm>
#include <fstream>
#include <iostream>
#include <span>
#include <unordered_map>
#include <utility>

#include "golden.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::testing {

struct GoldenRow;

/// A comma-separated file with a header line.
class GoldenTable {
 public:
  explicit GoldenTable(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line)) throw std::runtime_error("no header in " + file.string());
    const auto names = split(line);
    for (std::size_t i = 0; i < names.size(); ++i) columns_[names[i]] = i;
    while (std::getline(in, line))
      if (!line.empty()) rows_.push_back(split(line));
  }

  std::size_t rows() const { return rows_.size(); }
  GoldenRow operator[](std::size_t row) const;

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells;
    std::size_t begin = 0;
    while (true) {
      const auto end = line.find(',', begin);
      cells.push_back(line.substr(begin, end - begin));
      if (end == std::string::npos) return cells;
      begin = end + 1;
    }
  }

  friend GoldenRow;
  std::unordered_map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// A row of a table; cells are read by the column's name.
struct GoldenRow {
  const GoldenTable& table;
  std::size_t row;

  bool has(const std::string& column) const { return table.columns_.count(column) > 0; }
  const std::string& text(const std::string& column) const {
    return table.rows_.at(row).at(table.columns_.at(column));
  }
  double real(const std::string& column) const { return std::stod(text(column)); }
  int integer(const std::string& column) const { return std::stoi(text(column)); }
  /// The columns prefix0, prefix1, ... as far as they go.
  std::vector<double> series(const std::string& prefix) const {
    std::vector<double> values;
    while (has(prefix + std::to_string(values.size())))
      values.push_back(real(prefix + std::to_string(values.size())));
    return values;
  }
};

inline GoldenRow GoldenTable::operator[](std::size_t row) const {
  return {*this, row};
}

/// Counts what was compared and keeps the largest error; reports both when it goes.
class Comparison {
 public:
  using Columns = std::vector<std::pair<const char*, double>>;

  explicit Comparison(std::string name) : name_(std::move(name)) {}
  ~Comparison() {
    std::cout << name_ << ": " << cases_ << " cases, " << values_ << " values, largest error " << worst_
              << "\n";
  }
  void next_case() { ++cases_; }
  /// The error of `actual` over max(1, |expected|).
  void relative(double actual, double expected) {
    note(std::abs(actual - expected) / std::max(1.0, std::abs(expected)));
  }
  void absolute(double actual, double expected) { note(std::abs(actual - expected)); }
  /// The same of several columns of a row.
  void relative(const GoldenRow& row, const Columns& columns) {
    for (const auto& [name, actual] : columns) relative(actual, row.real(name));
  }
  void absolute(const GoldenRow& row, const Columns& columns) {
    for (const auto& [name, actual] : columns) absolute(actual, row.real(name));
  }
  void absolute(std::span<const double> actual, const std::vector<double>& expected) {
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < actual.size(); ++i) absolute(actual[i], expected[i]);
  }
  int cases() const { return cases_; }
  double worst() const { return worst_; }

 private:
  void note(double error) {
    ++values_;
    // Not std::max: a NaN must stay.
    if (!(error <= worst_)) worst_ = error;
  }

  std::string name_;
  int cases_ = 0;
  long values_ = 0;
  double worst_ = 0;
};

/// The columns of a car's state.
inline Comparison::Columns columns(const sim::CarState& s) {
  return {{"x", s.x},      {"y", s.y},     {"delta", s.steer},
          {"v", s.speed},  {"psi", s.yaw}, {"psidot", s.yaw_rate},
          {"beta", s.slip}};
}

/// Calls `visit(begin, end)` for the rows of each case of a table.
template <class Visit>
void visit_cases(const GoldenTable& table, Visit&& visit) {
  for (std::size_t begin = 0, end; begin < table.rows(); begin = end) {
    end = begin;
    while (end < table.rows() && table[end].text("case") == table[begin].text("case")) ++end;
    visit(begin, end);
  }
}

/// Calls `compare(row, compared)` for each row of the golden table NAME.csv of the simulator; the errors must
/// not exceed `tolerance`. Skips the test where the golden data are absent.
template <class Compare>
void compare_rows(const std::string& name, double tolerance, Compare&& compare) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / (name + ".csv"));
  Comparison compared(name);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    compare(table[row], compared);
    ASSERT_LE(compared.worst(), tolerance) << "row " << row;
  }
  EXPECT_GT(compared.cases(), 0);
}

}  // namespace slalom::testing
