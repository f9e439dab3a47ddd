#include <chrono>
#include <optional>

#include "controller.hpp"
#include "slalom/view/serve.hpp"

namespace slalom::python {
namespace {

/// The arguments of `slalom.show` that say how a problem is drawn.
struct Drawing {
  std::vector<double> start;
  int x = 0, y = 1;  ///< indices of states
  std::optional<int> heading;
  py::object pose, figure, shapes, goals, move, clock, plant;
};

/// An array of points (n, 2), or of places (n, 3).
Numbers places_of(const py::object& values, const std::string& what, bool may_have_yaw) {
  const auto array = Numbers::ensure(values);
  if (!array || array.ndim() != 2 || (array.shape(1) != 2 && !(may_have_yaw && array.shape(1) == 3)))
    throw py::value_error(what + ": must be an array (n, 2)" + (may_have_yaw ? " or (n, 3)" : ""));
  return array;
}

view::Line line_of(const py::object& values, const std::string& what) {
  const Numbers array = places_of(values, what, false);
  view::Line line;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) line.push_back({array.at(i, 0), array.at(i, 1)});
  return line;
}

view::Shape shape_of(const py::object& values, view::ShapeKind kind) {
  const auto array = Numbers::ensure(values);
  if (array && array.ndim() == 1 && array.size() == 3)
    return view::disc(array.at(0), array.at(1), array.at(2), kind);
  if (kind == view::ShapeKind::goal) throw py::value_error("goals: each must be (x, y, radius)");
  if (array && array.ndim() == 1 && array.size() == 5)
    return view::box({array.at(0), array.at(1), array.at(2)}, array.at(3), array.at(4));
  return view::polygon(
      line_of(values, "shapes: each (x, y, radius), (x, y, yaw, length, width), or a polygon"));
}

/// A controller of Python with its drawing. The page's thread holds the interpreter lock in every function.
class PythonSubject final : public view::SolverSubject {
 public:
  PythonSubject(py::object controller, std::shared_ptr<const Drawing> drawing,
                std::shared_ptr<const view::SubjectFacts> facts)
      : drawing_(std::move(drawing)), facts_(std::move(facts)) {
    set_controller(std::move(controller));
  }
  ~PythonSubject() override {
    const py::gil_scoped_acquire lock;
    controller_ = py::object();
    drawing_.reset();
  }

  std::unique_ptr<view::Subject> clone() const override {
    const py::gil_scoped_acquire lock;
    auto copy = std::make_unique<PythonSubject>(*this);
    copy->set_controller(py::module_::import("copy").attr("copy")(controller_));
    return copy;
  }
  const view::SubjectFacts& facts() const override { return *facts_; }
  std::vector<double> start() const override { return drawing_->start; }
  double time_step() const override { return problem().evaluator().time_step(); }
  const SolverOptions* options() const override { return &controller().options(); }
  void set_options(const SolverOptions& options) override {
    const py::gil_scoped_acquire lock;
    set_controller(py::type::of<Controller>()(options.method(), controller_.attr("problem"),
                                              **values_of(list_options(options))));
  }

  const SolveResult& solve(std::span<const double> state, const SolveRequest& request) override {
    const py::gil_scoped_acquire lock;
    if (!drawing_->clock.is_none()) drawing_->clock(controller_.attr("problem"), time_);
    controller().solve(controller_, {state.begin(), state.end()}, request);
    return controller().result();
  }
  std::span<const double> inputs() const override { return controller().inputs(); }
  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences) override {
    const py::gil_scoped_acquire lock;
    return problem().roll_out(state, sequences, controller().solver().horizon(), facts_->terms);
  }
  std::vector<double> step(std::span<const double> state, std::span<const double> input) override {
    const py::gil_scoped_acquire lock;
    if (drawing_->plant.is_none()) return problem().step(state, input, 0);
    return drawing_->plant(array_of(state), array_of(input)).cast<std::vector<double>>();
  }

  std::vector<maps::Pose> poses(std::span<const double> states) override {
    const py::gil_scoped_acquire lock;
    const Drawing& d = *drawing_;
    const auto width = d.start.size(), count = states.size() / width;
    std::vector<maps::Pose> all(count);
    if (!d.pose.is_none()) {
      const Numbers given({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(width)}, states.data());
      const Numbers places = places_of(d.pose(given), "pose: its result", true);
      if (places.shape(0) != given.shape(0))
        throw py::value_error("pose: must return a place for each state");
      for (std::size_t i = 0; i < count; ++i) {
        const auto at = static_cast<py::ssize_t>(i);
        all[i] = {places.at(at, 0), places.at(at, 1), places.shape(1) == 3 ? places.at(at, 2) : 0};
      }
      return all;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double* const state = &states[i * width];
      all[i] = {state[d.x], state[d.y], d.heading ? state[*d.heading] : 0};
    }
    return all;
  }
  std::vector<view::Shape> shapes() override {
    const py::gil_scoped_acquire lock;
    std::vector<view::Shape> all;
    for (const auto kind : {view::ShapeKind::obstacle, view::ShapeKind::goal}) {
      const py::object& given = kind == view::ShapeKind::goal ? drawing_->goals : drawing_->shapes;
      if (given.is_none()) continue;
      const py::object now = PyCallable_Check(given.ptr()) ? given(controller_.attr("problem")) : given;
      for (const py::handle& each : now)
        all.push_back(shape_of(py::reinterpret_borrow<py::object>(each), kind));
    }
    return all;
  }
  std::vector<view::Line> figure(std::span<const double> state) override {
    const py::gil_scoped_acquire lock;
    std::vector<view::Line> all;
    if (drawing_->figure.is_none()) return all;
    for (const py::handle& line : drawing_->figure(array_of(state)))
      all.push_back(line_of(py::reinterpret_borrow<py::object>(line), "figure: a line"));
    return all;
  }
  void place(std::span<double> state, const maps::Pose& to) override {
    const auto at = [&](int i) -> double& { return state[static_cast<std::size_t>(i)]; };
    at(drawing_->x) = to.x;
    at(drawing_->y) = to.y;
    if (drawing_->heading) at(*drawing_->heading) = to.yaw;
  }
  void move(int shape, const maps::Pose& to) override {
    const py::gil_scoped_acquire lock;
    drawing_->move(controller_.attr("problem"), shape, to.x, to.y);
  }

 private:
  /// Requires the interpreter lock, unlike those that read it.
  void set_controller(py::object controller) {
    native_ = py::cast<Controller*>(controller);
    controller_ = std::move(controller);
  }
  Controller& controller() const { return *native_; }
  AnyProblem& problem() const { return controller().problem(); }

  py::object controller_;
  Controller* native_ = nullptr;  ///< owned by `controller_`
  std::shared_ptr<const Drawing> drawing_;
  std::shared_ptr<const view::SubjectFacts> facts_;
};

std::unique_ptr<view::View> make_view(const py::object& controller, Drawing drawing, view::SubjectFacts facts,
                                      const view::ServeOptions& options) {
  auto& native = controller.cast<Controller&>();
  AnyProblem& problem = native.problem();
  const int states = problem.states();
  checked(drawing.start, static_cast<std::size_t>(states), "start");
  for (const int index : {drawing.x, drawing.y, drawing.heading.value_or(0)})
    if (drawing.pose.is_none() && (index < 0 || index >= states))
      throw py::value_error("x, y, heading: " + std::to_string(index) +
                            " must be an index of a state, in [0, " + std::to_string(states - 1) + "]");
  const auto inputs = static_cast<std::size_t>(problem.inputs());
  view::fill_names(facts.states, drawing.start.size(), "state", "state_names");
  view::fill_names(facts.inputs, inputs, "input", "input_names");
  facts.can_place = drawing.pose.is_none();
  facts.can_move = !drawing.move.is_none();
  const std::vector<double> rest(static_cast<std::size_t>(native.solver().horizon()) * inputs);
  for (const auto& [name, value] : problem.predict(drawing.start, rest).terms) facts.terms.push_back(name);
  auto subject =
      std::make_unique<PythonSubject>(py::module_::import("copy").attr("copy")(controller),
                                      std::make_shared<const Drawing>(std::move(drawing)),
                                      std::make_shared<const view::SubjectFacts>(std::move(facts)));
  return std::make_unique<view::View>(std::move(subject), options);
}

}  // namespace

void bind_view(py::module_& module) {
  py::class_<view::View>(module, "_View", "A page that shows a controller; slalom.show makes it.", guarded())
      .def(py::init([](const py::object& controller, std::vector<double> start, int x, int y,
                       std::optional<int> heading, py::object pose, double length, double width,
                       py::object figure, py::object shapes, py::object goals, py::object move,
                       py::object clock, std::optional<maps::OccupancyGrid> map, py::object plant,
                       std::vector<std::string> state_names, std::vector<std::string> input_names,
                       const std::string& title, const std::string& host, std::uint16_t port,
                       const std::string& token, const std::string& against) {
             return make_view(
                 controller,
                 {std::move(start), x, y, heading, std::move(pose), std::move(figure), std::move(shapes),
                  std::move(goals), std::move(move), std::move(clock), std::move(plant)},
                 {.title = title,
                  .states = std::move(state_names),
                  .inputs = std::move(input_names),
                  .length = length,
                  .width = width,
                  .map = std::move(map)},
                 {.host = host, .port = port, .token = token, .against = against});
           }),
           "controller"_a, "start"_a, py::kw_only(), "x"_a = 0, "y"_a = 1, "heading"_a = py::none(),
           "pose"_a = py::none(), "length"_a = 0.0, "width"_a = 0.0, "figure"_a = py::none(),
           "shapes"_a = py::none(), "goals"_a = py::none(), "move"_a = py::none(), "clock"_a = py::none(),
           "map"_a = py::none(), "plant"_a = py::none(), "state_names"_a = std::vector<std::string>{},
           "input_names"_a = std::vector<std::string>{}, "title"_a = "", "host"_a = "127.0.0.1",
           "port"_a = 8400, "token"_a = "", "against"_a = "")
      .def_property_readonly("address", &view::View::address, "The address of the page.")
      .def(
          "turn",
          [](view::View& view, double seconds) {
            const py::gil_scoped_release unlock;
            view.turn(
                std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
          },
          "seconds"_a = 0.05,
          "Executes the commands of the page and drives the step that is due; waits for one, for `seconds` "
          "at most.");
}

}  // namespace slalom::python
