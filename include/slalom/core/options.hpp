#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Declarations of options: the command line, the configuration files, the bindings and the view's sliders
/// are derived from them.
///
/// An options type is a flat aggregate whose fields carry their defaults. A function template below it
/// describes every field once, in the order name, unit, help, least value, largest value, symbol:
///
///     template <class Options, class Visit>
///       requires is_options_of<Options, MppiOptions>
///     void visit_options(Options& o, Visit&& visit) {
///       visit(o.temperature, {"temperature", "", "cost difference at which ...", 1e-6, no_limit, "lambda"});
///     }
///
/// Fields are `bool`, `int`, `std::uint64_t`, `double`, `PerInput` or an enumeration with an `enum_names(E)`
/// function (or a `Choice`, a reference to one).
namespace slalom {

/// The bound of an option that has none.
inline constexpr double no_limit = std::numeric_limits<double>::infinity();

/// The description of an option. Its type and its default are those of the field.
struct Declaration {
  const char* name = "";    ///< name in configurations
  const char* unit = "";    ///< unit of the values; "input" is the unit of an input
  const char* help = "";    ///< effect, in one line
  double min = -no_limit;   ///< least value, of each entry
  double max = no_limit;    ///< largest value, of each entry
  const char* symbol = "";  ///< symbol in the paper
  bool any_count = false;   ///< a PerInput takes any number of values, not one for each input
};

/// A reference to an enumeration of any type, for code that is compiled once for all options. It stands where
/// an enumeration stands in a call of `visit`.
class Choice {
 public:
  /// A reference to an enumeration that has `enum_names`.
  template <class Enumeration>
  requires std::is_enum_v<Enumeration>
  explicit Choice(Enumeration& field)
      : field_(&field),
        names_(enum_names(field)),
        get_([](const void* from) { return static_cast<int>(*static_cast<const Enumeration*>(from)); }),
        set_([](void* to, int index) { *static_cast<Enumeration*>(to) = static_cast<Enumeration>(index); }) {}

  /// The names of the enumerators, ended by a null pointer.
  const char* const* names() const noexcept { return names_; }
  /// Index of the enumerator.
  int index() const { return get_(field_); }
  /// Sets the enumerator by its index.
  void set(int index) const { set_(field_, index); }

 private:
  void* field_;
  const char* const* names_;
  int (*get_)(const void*);
  void (*set_)(void*, int);
};

/// Whether `Options` is `Of`, const or not.
template <class Options, class Of>
concept is_options_of = std::is_same_v<std::remove_const_t<Options>, Of>;

/// One value per input, or one for all inputs. With `Declaration::any_count` it is a list of any length.
class PerInput {
 public:
  /// One value for all inputs.
  PerInput(double value) : values_{value} {}
  /// One value for each input.
  PerInput(std::initializer_list<double> values) : values_(values) {}
  /// One value for each input.
  PerInput(std::vector<double> values) : values_(std::move(values)) {}

  /// The values as given.
  const std::vector<double>& values() const noexcept { return values_; }
  /// The value of one input.
  double operator[](int input) const {
    return values_.size() == 1 ? values_[0] : values_.at(static_cast<std::size_t>(input));
  }
  /// Whether there is one value, or one for each of `inputs`.
  bool fits(int inputs) const noexcept {
    return values_.size() == 1 || static_cast<int>(values_.size()) == inputs;
  }
  bool operator==(const PerInput&) const = default;

 private:
  std::vector<double> values_;
};

namespace detail {

/// Throws std::invalid_argument that names the option, its value and the rule.
[[noreturn]] void throw_out_of_range(std::string_view where, const Declaration& declaration, double value);
[[noreturn]] void throw_wrong_count(std::string_view where, const Declaration& declaration, std::size_t count,
                                    int inputs);

inline void check(std::string_view where, const Declaration& d, double value) {
  if (!(value >= d.min && value <= d.max)) throw_out_of_range(where, d, value);
}

}  // namespace detail

/// Checks every option against its declared range and every per-input option against the number of inputs (0:
/// any). Throws std::invalid_argument, for instance "svg_mppi.samples: 0 must be in [1, 4194304]".
template <class Options>
void validate_options(const Options& options, std::string_view where, int inputs = 0) {
  visit_options(options, [&](const auto& field, const Declaration& declaration) {
    using Field = std::remove_cvref_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, PerInput>) {
      if (inputs > 0 && !declaration.any_count && !field.fits(inputs))
        detail::throw_wrong_count(where, declaration, field.values().size(), inputs);
      if (field.values().empty()) detail::throw_wrong_count(where, declaration, 0, inputs);
      for (const double value : field.values()) detail::check(where, declaration, value);
    } else if constexpr (std::is_arithmetic_v<Field> && !std::is_same_v<Field, bool>) {
      detail::check(where, declaration, static_cast<double>(field));
    }
  });
}

}  // namespace slalom
