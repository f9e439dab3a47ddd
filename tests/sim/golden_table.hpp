#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iostream>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "golden.hpp"

namespace slalom::testing {

/// A comma-separated file with a header line; cells are read by the column's name.
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
  bool has(const std::string& column) const { return columns_.count(column) > 0; }
  const std::string& text(std::size_t row, const std::string& column) const {
    return rows_.at(row).at(columns_.at(column));
  }
  double real(std::size_t row, const std::string& column) const { return std::stod(text(row, column)); }
  int integer(std::size_t row, const std::string& column) const { return std::stoi(text(row, column)); }

  /// The columns prefix0, prefix1, ... as far as they go.
  std::vector<double> series(std::size_t row, const std::string& prefix) const {
    std::vector<double> values;
    for (auto it = columns_.find(prefix + "0"); it != columns_.end();
         it = columns_.find(prefix + std::to_string(values.size())))
      values.push_back(std::stod(rows_.at(row).at(it->second)));
    return values;
  }

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

  std::unordered_map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// A row of a table.
struct GoldenRow {
  const GoldenTable& table;
  std::size_t row;

  const std::string& text(const std::string& column) const { return table.text(row, column); }
  double real(const std::string& column) const { return table.real(row, column); }
  int integer(const std::string& column) const { return table.integer(row, column); }
  std::vector<double> series(const std::string& prefix) const { return table.series(row, prefix); }
};

/// Counts what was compared and keeps the largest error; reports both when it goes.
class Comparison {
 public:
  using Columns = std::initializer_list<std::pair<const char*, double>>;

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
  void relative(const GoldenRow& row, Columns columns) {
    for (const auto& [name, actual] : columns) relative(actual, row.real(name));
  }
  void absolute(const GoldenRow& row, Columns columns) {
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

/// Calls `compare(row, compared)` for each row of the golden table NAME.csv of the simulator; the errors must
/// not exceed `tolerance`. Skips the test where the golden data are absent.
template <class Compare>
void compare_rows(const std::string& name, double tolerance, Compare&& compare) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / (name + ".csv"));
  Comparison compared(name);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    compare(GoldenRow{table, row}, compared);
    ASSERT_LE(compared.worst(), tolerance) << "row " << row;
  }
  EXPECT_GT(compared.cases(), 0);
}

}  // namespace slalom::testing
