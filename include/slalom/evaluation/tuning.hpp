#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"

/// A search for better options: successive halving (Jamieson & Talwalkar, "Non-stochastic Best Arm
/// Identification and Hyperparameter Optimization", AISTATS 2016) over a quasi-random design, repeated in a
/// box half as wide around the best candidate. All candidates drive the same seeds, so that they are compared
/// lap by lap.
namespace slalom::evaluation {

/// An option to be searched and its range.
struct SearchDimension {
  std::string key;                   ///< key: section.option
  double low = 0, high = 0;          ///< bounds of a number
  bool logarithmic = false;          ///< uniform in the logarithm
  bool whole = false;                ///< whole numbers, both ends included
  std::vector<std::string> choices;  ///< the values, instead of a range

  /// The value at the coordinate `place` in [0, 1], as text. Numbers keep five significant digits.
  std::string value(double place) const;
  /// The coordinate in [0, 1] of a value; of the nearest value in the range if it is outside, of the first
  /// choice or the lower end if the text is not one of the choices or not a number.
  double place(const std::string& value) const;
};

/// Reads "key=lo:hi", "key=lo:hi:log" or "key=v1,v2,..."; a key without a section is one of `method`. Throws
/// std::invalid_argument if the text, the option or a value is invalid.
SearchDimension parse_dimension(const std::string& text, const vehicle::Configuration& configuration,
                                const std::string& method);

/// The value of an option as text; "" if the key is unknown.
std::string option_text(const vehicle::Configuration& configuration, const std::string& key);

/// A candidate of the search.
struct Candidate {
  std::vector<double> place;                             ///< point of the unit cube
  std::vector<std::pair<std::string, std::string>> set;  ///< keys and values
};

/// `count` points that fill a box of the unit cube evenly: Kronecker's sequence with the generalised golden
/// ratio (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), from its entry `first`
/// on. The box is `width` wide around `centre` and is shifted into the cube.
std::vector<Candidate> design(const std::vector<SearchDimension>& dimensions,
                              const std::vector<double>& centre, double width, int first, int count);

/// A step of successive halving.
struct Rung {
  int candidates = 0;  ///< candidates that are compared
  int laps = 0;        ///< laps that each has driven at the end of the step
};
/// The steps of a round: half of the candidates continue with twice the laps, until one is left.
std::vector<Rung> halving(int candidates, int laps);
/// The number of laps driven in these steps.
int laps_of(const std::vector<Rung>& rungs);
/// The largest number of candidates of a round with at most `budget` laps, at most 4096; below 2 if
/// no round is possible.
int candidates_for(int budget, int laps);

/// The objective to be minimised: a weighted sum of figures of a lap, for instance "ms", "log_ms + 5
/// failures" or "lap_time+3*contacts".
class Objective {
 public:
  /// Throws std::invalid_argument with a list of the known figures.
  explicit Objective(std::string_view text);
  /// The value for a lap.
  double of(const LapRow& row) const noexcept;
  /// Names and meanings of the figures.
  static std::vector<std::pair<const char*, const char*>> figures();

 private:
  struct Term {
    double weight;
    std::size_t figure;
  };
  std::vector<Term> terms_;
};

}  // namespace slalom::evaluation
