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

namespace slalom::testing {

using Json = nlohmann::json;

/// Reads a line of JSON in which NaN, Infinity and -Infinity stand bare; they become strings.
inline Json parse_line(const std::string& line) {
  std::string text;
  text.reserve(line.size() + 64);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] == '"') quoted = !quoted;
    std::size_t length = 0;
    if (!quoted) {
      for (const char* token : {"NaN", "-Infinity", "Infinity"}) {
        if (line.compare(i, std::char_traits<char>::length(token), token) == 0) {
          length = std::char_traits<char>::length(token);
          break;
        }
      }
    }
    if (length == 0) {
      text += line[i++];
    } else {
      text += '"' + line.substr(i, length) + '"';
      i += length;
    }
  }
  return Json::parse(text);
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

/// Control sequences [sample][row] as the solvers hold them, [row][sample], padded.
struct Batch {
  std::vector<float> values;
  int samples = 0, stride = 0, rows = 0;

  explicit Batch(const Json& sequences)
      : samples(static_cast<int>(sequences.size())),
        stride((samples + simd::padding - 1) / simd::padding * simd::padding),
        rows(static_cast<int>(sequences.at(0).size())) {
    values.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows));
    for (int k = 0; k < samples; ++k)
      for (int r = 0; r < rows; ++r)
        view().row(r)[k] =
            static_cast<float>(number(sequences[static_cast<std::size_t>(k)][static_cast<std::size_t>(r)]));
  }
  Batch(int rows_of, int samples_of)
      : samples(samples_of),
        stride((samples + simd::padding - 1) / simd::padding * simd::padding),
        rows(rows_of) {
    values.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows));
  }
  detail::Rows view() { return {values.data(), stride, rows}; }
  detail::Range range() const { return {0, stride}; }
  std::vector<float> sequence(int sample) {
    std::vector<float> result;
    for (int r = 0; r < rows; ++r) result.push_back(view().row(r)[sample]);
    return result;
  }
};

/// Values [sample], padded with `fill`.
inline std::vector<float> padded_numbers(const Json& list, float fill) {
  auto values = numbers<float>(list);
  values.resize((values.size() + simd::padding - 1) / simd::padding * simd::padding, fill);
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
