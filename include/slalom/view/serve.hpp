#pragma once

#include <atomic>
#include <chrono>

#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/trajectories.hpp"
#include "slalom/view/subject.hpp"

/// A page in the browser that shows how a controller solves your own problem, with its options, charts, pause
/// and the past, and obstacles that you can drag:
///
///     slalom::view::serve(controller, {.start = {0, 0, 0}, .x = &State::x, .y = &State::y});
///
/// and open the address that it prints.
namespace slalom::view {

/// How a problem is drawn. Only `start`, and `x` and `y` or `pose`, must be given.
template <class P>
struct Drawing {
  using State = typename Controller<P>::State;    ///< state of the problem
  using Inputs = typename Controller<P>::Inputs;  ///< inputs of a step
  using Member = double State::*;                 ///< a member of the state

  State start{};                                   ///< the state in which the drive begins
  Member x = nullptr, y = nullptr;                 ///< members with the position, m; the page can change them
  Member heading = nullptr;                        ///< member with the heading, rad, if there is one
  std::function<maps::Pose(const State&)> pose{};  ///< the place of a state that has no such members
  double length = 0, width = 0;                    ///< m, of the body; 0: it is a dot
  /// Lines that show the body, such as the rod of a pendulum.
  std::function<std::vector<Line>(const State&)> figure{};
  /// Discs, boxes and polygons, by the problem's parameters.
  std::function<std::vector<Shape>(const P&)> shapes{};
  /// Puts a shape elsewhere, by its index in `shapes`. Without it, shapes cannot be dragged.
  std::function<void(P&, int shape, const maps::Point& to)> move{};
  /// Sets what changes with time. Called before each solve with the s since the start.
  std::function<void(P&, double time)> clock{};
  std::optional<maps::OccupancyGrid> map{};  ///< drawn under all else
  /// The real system; by default the problem itself.
  std::function<State(const State&, const Inputs&)> plant{};
  std::vector<std::string> states{}, inputs{};  ///< names with their units, such as "speed, m/s"
  std::string title{};                          ///< name of the problem
};

/// Where the page is served.
struct ServeOptions {
  std::string host = "127.0.0.1";  ///< IP address to listen on
  std::uint16_t port = 8400;       ///< the first that is free from here on, of ten; 0: any
  /// Must stand in the address as ?token=...; needed for addresses that other machines can reach.
  std::string token{};
  std::string against{};  ///< a second method, which drives beside the first from the start
  /// Called with the address of the page once it is served; by default `serve` prints it.
  std::function<void(const std::string& address)> ready{};
};

/// Prints the address of a page, and how to end.
void print_address(const std::string& address);

/// A page that shows a subject.
class View {
 public:
  /// Serves the page from now on. Throws std::invalid_argument if an option or the subject is not valid,
  /// std::runtime_error if the port cannot be used.
  explicit View(std::unique_ptr<Subject> subject, const ServeOptions& options = {});
  ~View();
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  const std::string& address() const noexcept;  ///< address of the page
  /// Executes the commands of the page and drives the step that is due; waits for one, for `at_most` at most.
  void turn(std::chrono::nanoseconds at_most);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

namespace detail {

/// A problem with its drawing.
template <Problem P>
class DrawnProblem : public virtual FrameSource {
 public:
  using State = typename Drawing<P>::State;

  explicit DrawnProblem(Drawing<P> drawing)
      : drawing_(std::make_shared<const Drawing<P>>(std::move(drawing))) {
    const Drawing<P>& d = *drawing_;
    if (!d.pose && !(d.x && d.y)) throw std::invalid_argument("drawing: must have x and y, or pose");
    SubjectFacts facts{.title = d.title,
                       .states = d.states,
                       .inputs = d.inputs,
                       .length = d.length,
                       .width = d.width,
                       .can_place = d.x && d.y,
                       .can_move = bool(d.move),
                       .can_collide = slalom::detail::can_collide<P>,
                       .map = d.map};
    fill_names(facts.states, state_size, "state", "Drawing.states");
    fill_names(facts.inputs, P::inputs, "input", "Drawing.inputs");
    for (const CostTerm& term : slalom::detail::cost_terms_of<P>()) facts.terms.emplace_back(term.name);
    facts_ = std::make_shared<const SubjectFacts>(std::move(facts));
  }

  const SubjectFacts& facts() const override { return *facts_; }
  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences) override {
    return slalom::roll_out<P>(evaluator(), state_of(state.data()), sequences, horizon());
  }
  std::vector<maps::Pose> poses(std::span<const double> states) override {
    std::vector<maps::Pose> all;
    for (std::size_t at = 0; at < states.size(); at += state_size) all.push_back(pose(state_of(&states[at])));
    return all;
  }
  std::vector<Shape> shapes() override {
    return drawing_->shapes ? drawing_->shapes(evaluator().problem()) : std::vector<Shape>{};
  }
  std::vector<Line> figure(std::span<const double> state) override {
    return drawing_->figure ? drawing_->figure(state_of(state.data())) : std::vector<Line>{};
  }

 protected:
  static constexpr std::size_t state_size = sizeof(State) / sizeof(double);

  virtual const ProblemEvaluator<P>& evaluator() const = 0;
  virtual int horizon() const = 0;

  const Drawing<P>& drawn() const { return *drawing_; }
  static State state_of(const double* from) {
    State state;
    std::memcpy(&state, from, sizeof state);
    return state;
  }

 private:
  maps::Pose pose(const State& x) const {
    const Drawing<P>& d = *drawing_;
    if (d.pose) return d.pose(x);
    return {x.*d.x, x.*d.y, d.heading ? x.*d.heading : 0};
  }

  std::shared_ptr<const Drawing<P>> drawing_;
  std::shared_ptr<const SubjectFacts> facts_;
};

/// A controller with its drawing.
template <Problem P>
class ControllerSubject final : public SolverSubject, public DrawnProblem<P> {
 public:
  using State = typename Drawing<P>::State;
  using Inputs = typename Drawing<P>::Inputs;

  ControllerSubject(Controller<P> controller, Drawing<P> drawing)
      : DrawnProblem<P>(std::move(drawing)), controller_(std::move(controller)) {}

  std::unique_ptr<Subject> clone() const override { return std::make_unique<ControllerSubject>(*this); }
  std::vector<double> start() const override { return values(drawn().start); }
  double time_step() const override { return controller_.evaluator().time_step(); }
  const SolverOptions* options() const override { return controller_.options(); }
  void set_options(const SolverOptions& options) override {
    controller_ = Controller<P>(controller_.problem(), options);
  }
  std::vector<OptionSection> parameters() const override {
    if constexpr (has_parameters) return {{"problem", list_options(controller_.problem())}};
    return {};
  }
  bool set_parameter(const std::string& section, [[maybe_unused]] const std::string& name,
                     [[maybe_unused]] const std::string& text) override {
    if constexpr (has_parameters)
      return section == "problem" && set_option(controller_.problem(), name, text);
    return false;
  }

  const SolveResult& solve(std::span<const double> state, const SolveRequest& request) override {
    if (drawn().clock) drawn().clock(controller_.problem(), time_);
    const Plan<P> plan = controller_.solve(state_of(state.data()), request);
    plan_.clear();
    for (const Inputs& u : plan.inputs) plan_.insert(plan_.end(), u.value, u.value + P::inputs);
    return plan.stats;
  }
  std::span<const double> inputs() const override { return plan_; }

  std::vector<double> step(std::span<const double> state, std::span<const double> input) override {
    Inputs u;
    std::copy_n(input.begin(), P::inputs, u.value);
    const State x = state_of(state.data());
    if (drawn().plant) return values(drawn().plant(x, u));
    const P& p = controller_.problem();
    return values(slalom::detail::step<P, double>(p, x, slalom::detail::look_up<P, double>(p, x), u, 0));
  }

  void place(std::span<double> state, const maps::Pose& to) override {
    State x = state_of(state.data());
    x.*drawn().x = to.x;
    x.*drawn().y = to.y;
    if (drawn().heading) x.*drawn().heading = to.yaw;
    std::memcpy(state.data(), &x, sizeof x);
  }
  void move(int shape, const maps::Pose& to) override {
    drawn().move(controller_.problem(), shape, {to.x, to.y});
  }

 private:
  using DrawnProblem<P>::drawn, DrawnProblem<P>::state_of, DrawnProblem<P>::state_size;
  static constexpr bool has_parameters = requires(P & p) {
    visit_options(p, [](auto&, const Declaration&) {});
  };

  const ProblemEvaluator<P>& evaluator() const override { return controller_.evaluator(); }
  int horizon() const override { return controller_.solver().horizon(); }
  static std::vector<double> values(const State& state) {
    std::vector<double> all(state_size);
    std::memcpy(all.data(), &state, sizeof state);
    return all;
  }

  Controller<P> controller_;
  std::vector<double> plan_;
};

}  // namespace detail

/// Serves a page that shows how a controller, of which it takes a copy, solves its problem, and prints its
/// address. Returns once `stop` is set. Throws like the constructor of `View`.
template <Problem P>
void serve(const Controller<P>& controller, std::type_identity_t<Drawing<P>> drawing,
           ServeOptions options = {}, const std::atomic<bool>& stop = false) {
  if (!options.ready) options.ready = print_address;
  View view(std::make_unique<detail::ControllerSubject<P>>(controller, std::move(drawing)), options);
  while (!stop) view.turn(std::chrono::milliseconds(50));
}

}  // namespace slalom::view
