#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/core/polymorphic.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// An options aggregate of a method, see `SolverOptions`.
template <class Options>
concept MethodOptions = requires {
  { Options::method } -> std::convertible_to<const char*>;
  // Second: for `SolverOptions` itself, this would check the constructor below, and so this concept, again.
  requires std::copy_constructible<Options>;
};

/// The options of any one method, so that the command line, configuration files, bindings and tests serve
/// every method without a list of them. A method's options are an aggregate with
///
///     static constexpr const char* method = "predictive_sampling";   // its name in configurations
///
/// and the functions `visit_options` (core/options.hpp) and
///
///     std::unique_ptr<Solver> make_solver(const PredictiveSamplingOptions&, int inputs,
///                                         std::shared_ptr<ThreadPool> pool);
///
/// in its namespace. `register_solver` (registry.hpp) makes the method known by its name.
class SolverOptions {
 public:
  /// A pointer to an option, by the type of the option.
  using OptionPointer = std::variant<bool*, int*, std::uint64_t*, double*, PerInput*, Choice>;
  /// Function that is called with an option and its declaration.
  using OptionVisitor = std::function<void(const OptionPointer&, const Declaration&)>;

  /// Takes the options of a method.
  template <MethodOptions Options>
  SolverOptions(Options options)
      : held_(std::unique_ptr<Base>(std::make_unique<Held<Options>>(std::move(options)))) {}

  /// The name of the method.
  const char* method() const noexcept { return held_->method(); }

  /// The aggregate itself; null if it is of another type.
  template <MethodOptions Options>
  Options* get_if() noexcept {
    auto* held = dynamic_cast<Held<Options>*>(held_.get());
    return held ? &held->options : nullptr;
  }
  /// The aggregate itself; null if it is of another type.
  template <MethodOptions Options>
  const Options* get_if() const noexcept {
    return const_cast<SolverOptions*>(this)->get_if<Options>();
  }

  /// The option of that name and type (`bool`, `int`, `std::uint64_t`, `double` or `PerInput`); null if there
  /// is none. Every registered method has `int` horizon and threads, `std::uint64_t` seed, and `PerInput`
  /// input_min and input_max.
  template <class Type>
  Type* find(std::string_view name) {
    Type* found = nullptr;
    held_->for_each([&](const OptionPointer& field, const Declaration& declaration) {
      if (name != declaration.name) return;
      if (Type* const* pointer = std::get_if<Type*>(&field)) found = *pointer;
    });
    return found;
  }
  /// The option of that name and type; null if there is none.
  template <class Type>
  const Type* find(std::string_view name) const {
    return const_cast<SolverOptions*>(this)->find<Type>(name);
  }

  /// Calls `visit` with every option in the order of the declarations.
  void for_each(const OptionVisitor& visit) const { const_cast<Base&>(*held_).for_each(visit); }

  /// Checks all options and makes the solver. Throws std::invalid_argument that names the option, its value
  /// and the rule.
  std::unique_ptr<Solver> make(int inputs, std::shared_ptr<ThreadPool> pool) const {
    return held_->make(inputs, std::move(pool));
  }

 private:
  struct Base {
    virtual ~Base() = default;
    virtual const char* method() const noexcept = 0;
    virtual std::unique_ptr<Base> clone() const = 0;
    virtual void for_each(const OptionVisitor& visit) = 0;
    virtual std::unique_ptr<Solver> make(int inputs, std::shared_ptr<ThreadPool> pool) const = 0;
  };

  template <class Options>
  struct Held final : Base {
    explicit Held(Options o) : options(std::move(o)) {}
    const char* method() const noexcept override { return Options::method; }
    std::unique_ptr<Base> clone() const override { return std::make_unique<Held>(options); }
    void for_each(const OptionVisitor& visit) override {
      visit_options(options, [&](auto& field, const Declaration& declaration) {
        if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(field)>>) {
          visit(Choice(field), declaration);
        } else {
          visit(&field, declaration);
        }
      });
    }
    std::unique_ptr<Solver> make(int inputs, std::shared_ptr<ThreadPool> pool) const override {
      return make_solver(options, inputs, std::move(pool));
    }
    Options options;
  };

  Polymorphic<Base> held_;
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, SolverOptions>
void visit_options(Options& options, Visit&& visit) {
  options.for_each([&](const SolverOptions::OptionPointer& any, const Declaration& declaration) {
    std::visit(
        [&](auto field) {
          if constexpr (std::is_same_v<decltype(field), Choice>) {
            visit(field, declaration);
          } else if constexpr (std::is_const_v<Options>) {
            visit(std::as_const(*field), declaration);
          } else {
            visit(*field, declaration);
          }
        },
        any);
  });
}

}  // namespace slalom
