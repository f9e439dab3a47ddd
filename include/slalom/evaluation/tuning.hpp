#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slalom/evaluation/lap_table.hpp"

/// A search for better options: successive halving (Jamieson & Talwalkar, "Non-stochastic Best Arm
/// Identification and Hyperparameter Optimization", AISTATS 2016) over a quasi-random design, repeated in a
/// box half as wide round the best. All candidates drive the same seeds, so that they are compared lap by
/// lap.
namespace slalom::evaluation {

/// An option that is searched, and where.
struct SearchDimension {
  std::string key;                   ///< section.option
  double low = 0, high = 0;          ///< of a number
  bool logarithmic = false;          ///< evenly in the logarithm
  bool whole = false;                ///< whole numbers, both ends among them
  std::vector<std::string> choices;  ///< where there is no range: these values

  /// The value at `place` in [0, 1], as text. Numbers keep five significant digits.
  std::string value(double place) const;
  /// The place in [0, 1] of a value; the nearest one of a value that is not in the range.
  double place(const std::string& value) const;
};

/// Reads "key=lo:hi", "key=lo:hi:log" or "key=v1,v2,..."; a key without a section is one of `method`. Throws
/// std::invalid_argument on what makes no sense and on values that the option does not take.
SearchDimension parse_dimension(const std::string& text, const vehicle::Configuration& configuration,
                                const std::string& method);

/// The value of an option as it is set, "" if there is none of that name.
std::string option_text(const vehicle::Configuration& configuration, const std::string& key);

/// A candidate: its place in the unit cube, and what it sets.
struct Candidate {
  std::vector<double> place;
  std::vector<std::pair<std::string, std::string>> set;
};

/// `count` places that fill a box of the unit cube evenly: Kronecker's sequence with the generalised golden
/// ratio (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), from its entry `first`
/// on. The box is `width` wide round `centre` and is pushed inwards where it would leave the cube.
std::vector<Candidate> design(const std::vector<SearchDimension>& dimensions,
                              const std::vector<double>& centre, double width, int first, int count);

/// A step of halving: `candidates` of them, each of which has driven `laps` laps at its end.
struct Rung {
  int candidates = 0;
  int laps = 0;
};
/// The rungs of a round: half of the candidates go on, with twice the laps, until one is left.
std::vector<Rung> halving(int candidates, int laps);
/// The laps driven in these rungs.
int laps_of(const std::vector<Rung>& rungs);
/// The most candidates a round can have for at most `budget` laps; fewer than 2 if there is no round.
int candidates_for(int budget, int laps);

/// What is minimised: a weighted sum of figures of a lap, "ms", "log_ms + 5 failures", "lap_time+3*contacts".
class Objective {
 public:
  /// Throws std::invalid_argument that lists the figures known.
  explicit Objective(std::string_view text);
  double of(const LapRow& row) const noexcept;
  /// The figures' names and what they are.
  static std::vector<std::pair<const char*, const char*>> figures();

 private:
  struct Term {
    double weight;
    std::size_t figure;
  };
  std::vector<Term> terms_;
};

}  // namespace slalom::evaluation
