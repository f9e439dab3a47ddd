#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "golden.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/methods/gaussian_fit.hpp"
#include "solvers/problems.hpp"

namespace slalom::testing {

using Json = nlohmann::json;
using detail::rows_of;

/// Reads a line of JSON in which NaN, Infinity and -Infinity stand bare; they become strings.
inline Json parse_line(std::string line) {
  for (const char* token : {"NaN", "Infinity"})
    for (auto at = line.find(token); at != std::string::npos; at = line.find(token, at + 3)) {
      line.insert(line.find_first_of(",]}", at), 1, '"');
      if (line[at - 1] == '-') --at;
      line.insert(at, 1, '"');
    }
  return Json::parse(line);
}

inline double number(const Json& value) {
  if (!value.is_string()) return value.get<double>();
  if (value == "NaN") return std::numeric_limits<double>::quiet_NaN();
  return value == "Infinity" ? std::numeric_limits<double>::infinity()
                             : -std::numeric_limits<double>::infinity();
}

/// A list of numbers in the precision of a test.
template <class Real>
std::vector<Real> numbers(const Json& list) {
  std::vector<Real> values;
  for (const Json& value : list) values.push_back(static_cast<Real>(number(value)));
  return values;
}

/// Calls `use(json)` for every line of a file.
template <class Use>
void for_each_line(const std::filesystem::path& path, Use use) {
  std::ifstream file(path);
  ASSERT_TRUE(file) << path;
  for (std::string line; std::getline(file, line);)
    if (!line.empty()) use(parse_line(line));
}

/// Control sequences [sample][row] as the solvers hold them.
inline SequenceBatch batch_of(const Json& sequences) {
  SequenceBatch batch(1, static_cast<int>(sequences.at(0).size()), static_cast<int>(sequences.size()));
  for (int k = 0; k < batch.samples(); ++k) batch.set_sample(k, numbers<float>(sequences[k]));
  return batch;
}
inline detail::Range all_of(const SequenceBatch& batch) {
  return {0, batch.stride()};
}

/// Values [sample], padded with `fill`.
inline std::vector<float> padded_numbers(const Json& list, float fill) {
  auto values = numbers<float>(list);
  values.resize(padded(static_cast<int>(values.size())), fill);
  return values;
}

/// The fit of the paper's program to points of a density.
inline detail::GaussianFit published_fit(const std::vector<double>& x, const std::vector<double>& density) {
  std::vector<double> square(x.size()), logarithm(x.size());
  const auto count = static_cast<int>(x.size());
  detail::fit_weights(density.data(), count, square.data(), logarithm.data());
  return detail::fit_gaussian_as_published(x.data(), square.data(), logarithm.data(), count);
}

/// Compares a golden set and says at its end how many cases there were and how large the largest error was.
class Comparison {
 public:
  Comparison(std::string what, double tolerance) : what_(std::move(what)), tolerance_(tolerance) {}
  ~Comparison() {
    std::printf("[ golden   ] %s: %d cases, largest error %.2g (tolerance %.0e)%s%s\n", what_.c_str(), cases_,
                largest_, tolerance_, note_.empty() ? "" : ", ", note_.c_str());
  }
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;

  void next_case() { ++cases_; }
  int cases() const { return cases_; }
  void note(std::string text) { note_ = std::move(text); }

  /// Errors are taken relative to the largest entry of `expected`, and to `scale` if that is larger.
  template <class Real>
  void compare(const std::vector<Real>& actual, const std::vector<double>& expected, const std::string& where,
               double scale = 0) {
    ASSERT_GE(actual.size(), expected.size()) << what_ << " " << where;
    for (const double value : expected) scale = std::max(scale, std::abs(value));
    if (scale == 0) scale = 1;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double error = std::abs(static_cast<double>(actual[i]) - expected[i]) / scale;
      EXPECT_LE(error, tolerance_) << what_ << " " << where << " entry " << i << ": " << actual[i]
                                   << " instead of " << expected[i];
      largest_ = std::max(largest_, std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
    }
  }

 private:
  std::string what_;
  double tolerance_;
  std::string note_;
  int cases_ = 0;
  double largest_ = 0;
};

inline std::string case_name(const Json& json) {
  return "case " + std::to_string(json.at("case_id").get<int>());
}

/// Calls `each(json, comparison)` for every case of a folder of the golden data.
template <class Each>
void compare_cases(const std::string& name, Each each, const char* precision = " (float32)") {
  const auto folder = golden_folder(("controller/" + name).c_str());
  if (folder.empty()) GTEST_SKIP() << "no golden data: set SLALOM_GOLDEN_DIR to a folder that has " << name;
  Comparison comparison(name + precision, 1e-4);
  for_each_line(folder / "cases.jsonl", [&](const Json& json) {
    comparison.next_case();
    each(json, comparison);
  });
  EXPECT_GT(comparison.cases(), 0);
}

}  // namespace slalom::testing
