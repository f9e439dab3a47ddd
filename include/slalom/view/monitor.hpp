#pragma once

#include "slalom/view/drawn_solve.hpp"
#include "slalom/view/serve.hpp"

/// The page of a controller that runs in your program: it shows plans and their samples, and changes nothing.
///
///     slalom::view::Monitor monitor(controller, {.x = &State::x, .y = &State::y});
///     while (driving) {
///       const auto plan = controller.solve(x, {.elapsed = dt});
///       apply(plan.inputs[0]);
///       monitor.show(controller, plan);
///     }
namespace slalom::view {

/// A step of a running controller.
struct WatchedStep {
  std::vector<double> state, inputs;  ///< the state in which it planned; inputs of the plan, [step][input]
  DrawnSolve solve;                   ///< samples and figures of the plan
  double time = 0, update_time = 0;  ///< s: when it planned, since the page began; of wall clock for the plan
};

/// Steps of a running controller, as the page shows them. The page's thread calls all functions.
class WatchedSource : public virtual FrameSource {
 public:
  /// Takes the newest step, of which the functions of FrameSource tell from now on; null if none has come
  /// since the last call.
  virtual const WatchedStep* take() = 0;
  virtual double time_step() const = 0;                              ///< s; 0: unknown
  virtual std::string method() const { return {}; }                  ///< name of the method
  virtual std::vector<OptionSection> options() const { return {}; }  ///< options that the page shows
};

/// Hands values from one thread to another. Neither waits, and of several values the newest arrives.
template <class Value>
class Handover {
 public:
  explicit Handover(const Value& value = {}) : slots_{value, value, value} {}  ///< each slot has `value`

  /// Lets `fill` write a value. Returns whether it replaces one that was not taken. Memory that the first
  /// value needs is then there for all.
  template <class Fill>
  bool give(const Fill& fill) {
    if (!std::exchange(has_begun_, true))
      for (Value& slot : slots_) fill(slot);
    else
      fill(slots_[back_]);
    const unsigned before = middle_.exchange(back_ | is_new);
    back_ = before & ~is_new;
    return (before & is_new) != 0;
  }
  /// Returns the newest value, which is valid until the next call; null if none has come since.
  const Value* take() {
    if ((middle_ & is_new) == 0) return nullptr;
    front_ = middle_.exchange(front_) & ~is_new;
    return &slots_[front_];
  }

 private:
  static constexpr unsigned is_new = 4;
  std::array<Value, 3> slots_;
  std::atomic<unsigned> middle_{1};
  unsigned back_ = 0, front_ = 2;
  bool has_begun_ = false;
};

/// Serves the page of a running controller from a thread of its own.
class MonitorPage {
 public:
  /// Serves the page from now on. Throws std::invalid_argument if an option is not valid, std::runtime_error
  /// if the port cannot be used.
  explicit MonitorPage(std::unique_ptr<WatchedSource> source, const ServeOptions& options = {});
  ~MonitorPage();
  MonitorPage(const MonitorPage&) = delete;
  MonitorPage& operator=(const MonitorPage&) = delete;

  const std::string& address() const noexcept;  ///< address of the page
  /// Calls `give` with the s since the page began, if one is open and no step came in the last 12 ms. It
  /// gives the source a step, and returns whether that replaces another. Does not wait, and throws nothing.
  template <class Give>
  void show(const Give& give) noexcept {
    if (!is_open()) return;
    try {
      const std::optional<double> time = due();
      if (!time || give(*time)) ++dropped_;
    } catch (const std::exception&) {  // no memory for the copy
      ++dropped_;
    }
  }
  /// Steps that no page shows since a newer one came too soon.
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  bool is_open() const noexcept;
  std::optional<double> due() noexcept;

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  std::atomic<std::uint64_t> dropped_{0};
};

namespace detail {

/// The steps of a controller whose problem has a drawing.
template <Problem P>
class WatchedController final : public WatchedSource, public DrawnProblem<P> {
 public:
  WatchedController(const Controller<P>& controller, Drawing<P> drawing)
      : DrawnProblem<P>(std::move(drawing)),
        moments_({controller.evaluator(), {}}),
        time_step_(controller.evaluator().time_step()) {
    if (controller.options())
      options_.push_back({controller.options()->method(), list_options(*controller.options())});
  }

  /// Copies a plan, and the problem as it is now. Returns as Handover::give.
  bool give(const Controller<P>& controller, const Plan<P>& plan, double time) {
    return moments_.give([&](Moment& to) {
      to.evaluator = controller.evaluator();
      const auto* const state = reinterpret_cast<const double*>(plan.states.data());
      to.step.state.assign(state, state + DrawnProblem<P>::state_size);
      to.step.inputs.clear();
      for (const auto& u : plan.inputs)
        to.step.inputs.insert(to.step.inputs.end(), u.value, u.value + P::inputs);
      to.step.solve.take(plan.stats, this->facts().length > 0);
      to.step.time = time;
      to.step.update_time = plan.stats.times.total;
    });
  }

  const WatchedStep* take() override {
    const Moment* const newest = moments_.take();
    if (newest) shown_ = newest;
    return newest ? &newest->step : nullptr;
  }
  double time_step() const override { return time_step_; }
  std::string method() const override { return options_.empty() ? "" : options_.front().name; }
  std::vector<OptionSection> options() const override { return options_; }
  std::span<const double> inputs() const override { return shown_->step.inputs; }

 private:
  struct Moment {
    ProblemEvaluator<P> evaluator;
    WatchedStep step;
  };
  const ProblemEvaluator<P>& evaluator() const override { return shown_->evaluator; }
  int horizon() const override { return static_cast<int>(shown_->step.solve.length) / P::inputs; }

  Handover<Moment> moments_;
  const Moment* shown_ = nullptr;
  double time_step_;
  std::vector<OptionSection> options_;
};

}  // namespace detail

/// Shows the plans of a controller on a page, as long as it exists.
template <Problem P>
class Monitor {
 public:
  /// Serves the page, of which `start`, `move`, `clock` and `plant` of the drawing mean nothing. Throws as
  /// MonitorPage does, or if the drawing is not valid.
  explicit Monitor(const Controller<P>& controller, std::type_identity_t<Drawing<P>> drawing,
                   const ServeOptions& options = {})
      : Monitor(std::make_unique<detail::WatchedController<P>>(controller, std::move(drawing)), options) {}

  /// Shows a plan that the controller has just made; the plan's memory may change afterwards. Call it from
  /// the thread that solves. It takes microseconds, and nothing while no page is open; it does not wait for
  /// the page, and does not allocate after the first plan.
  void show(const Controller<P>& controller, const Plan<P>& plan) noexcept {
    page_.show([&](double time) { return source_->give(controller, plan, time); });
  }
  const std::string& address() const noexcept { return page_.address(); }  ///< address of the page
  std::uint64_t dropped() const noexcept { return page_.dropped(); }       ///< as MonitorPage::dropped

 private:
  Monitor(std::unique_ptr<detail::WatchedController<P>> source, const ServeOptions& options)
      : source_(source.get()), page_(std::move(source), options) {}

  detail::WatchedController<P>* source_;
  MonitorPage page_;
};

}  // namespace slalom::view
