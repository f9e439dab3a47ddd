"""The text, pickles and copies of objects; the type stubs; callables of torch."""

import ast
import copy
import pathlib
import pickle
import shutil
import subprocess
import sys

import numpy as np
import pytest
import slalom
from test_controllers import linear

FOLDER = pathlib.Path(slalom.__file__).parent


def point(**changes):
    return linear(**{"input_min": -2, "input_max": [2], **changes})


def test_problems_print_as_they_are_made():
    assert repr(slalom.CartPole()) == "slalom.CartPole()" and repr(slalom.CartPole(track=3.5)) == "slalom.CartPole(track=3.5)"
    drive = slalom.DifferentialDrive(goal_x=3)
    drive.discs = [(1, 0, 0.5)] * 3
    assert repr(drive) == "slalom.DifferentialDrive(goal_x=3.0, discs=[(1.0, 0.0, 0.5), (1.0, 0.0, 0.5), (1.0, 0.0, 0.5)])"
    assert repr(point()) == ("slalom.Problem(dynamics=dynamics, cost=cost, states=2, inputs=1, dt=0.1, input_min=-2.0, "
                             "input_max=2.0)")


def test_controllers_print_what_differs_from_the_defaults():
    controller = slalom.SvgMppi(slalom.CartPole(), horizon=12, input_min=-10, input_max=10)
    assert repr(controller) == "slalom.SvgMppi(slalom.CartPole(), horizon=12, input_min=-10.0, input_max=10.0)"
    assert eval(repr(controller)).options == controller.options
    general = slalom.Controller("mppi", slalom.CartPole(), samples=10)
    assert repr(general) == "slalom.Controller('mppi', slalom.CartPole(), samples=10)"


def test_plans_print_their_outcome_and_do_not_break_once_they_are_old():
    controller = slalom.Mppi(slalom.CartPole(), horizon=12, samples=100)
    plan = controller.solve([0, 0, 0.1, 0])
    assert repr(plan).startswith(f"<slalom.Plan 'ok' by mppi: 12 steps, cost {plan.cost:.6g}, ")
    assert "of 100" in repr(plan)
    controller.solve([0, 0, 0.1, 0])
    assert repr(plan) == "<slalom.Plan of an earlier solve>"


PROBLEMS = [slalom.CartPole(track=3.5), slalom.Arm(ball_radius=0.2), point(), point(dt=0)]


@pytest.mark.parametrize("problem", PROBLEMS)
def test_problems_and_controllers_are_pickled(problem):
    assert repr(pickle.loads(pickle.dumps(problem))) == repr(copy.deepcopy(problem)) == repr(problem)
    state = np.full(problem.states, 0.1)
    controller = slalom.SvgMppi(problem, horizon=8, samples=64, input_max=1, seed=3)
    same = pickle.loads(pickle.dumps(controller))
    assert type(same) is slalom.SvgMppi and same.options == controller.options
    assert np.array_equal(same.solve(state).inputs, controller.solve(state).inputs)
    with pytest.raises(RuntimeError, match="copy.copy"):
        pickle.dumps(controller)
    general = pickle.loads(pickle.dumps(slalom.Controller("mppi", problem, samples=10)))
    assert type(general) is slalom.Controller and general.options["samples"] == 10


@pytest.mark.parametrize("method", slalom.methods())
@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy])
@pytest.mark.parametrize("problem", [PROBLEMS[0], point(input_rate_max=3)])
def test_a_copy_of_a_controller_goes_on_with_the_same_bits(method, again, problem):
    state = np.full(problem.states, 0.1)
    controller = slalom.Controller(method, problem, horizon=8, samples=64, input_min=-1, input_max=1)
    for _ in range(3):
        controller.solve(state, elapsed=0.1)
    same = again(controller)
    assert type(same) is type(controller) and same.problem is not controller.problem
    for _ in range(3):
        first, second = (each.solve(state, elapsed=0.1) for each in (controller, same))
        assert np.array_equal(first.inputs, second.inputs) and np.array_equal(first.samples, second.samples)
        assert second.controller is same
        state = problem.step(state, first.inputs[0])
    assert type(again(slalom.SvgMppi(problem))) is slalom.SvgMppi


def objects():
    """An object of every compiled class."""
    controller = slalom.SvgMppi(slalom.CartPole(), horizon=8, samples=64)
    field = slalom.Field(np.zeros((2, 2)), 0.1)
    streams = []
    risk = slalom.RiskEvaluator(slalom.CartPole(), lambda random: streams.append(random) or slalom.CartPole())
    made = [controller, controller.solve([0, 0, 0.1, 0]), field, slalom.OccupancyGrid(np.zeros((2, 2)), 0.1), point(), risk,
            streams[0]]
    made += [cls() for cls in (slalom.Arm, slalom.Pendulum, slalom.CartPole, slalom.DifferentialDrive, slalom.Quadrotor,
                               slalom.Car)]
    made += [cls(slalom.CartPole()) for cls in vars(slalom._slalom).values()
             if isinstance(cls, type) and issubclass(cls, slalom.Controller) and cls is not slalom.Controller]
    if hasattr(slalom, "Course"):
        course = slalom.Course("wren")
        costmap, body = slalom.Costmap(slalom.OccupancyGrid(np.zeros((30, 30)), 0.1)), slalom.Footprint.rectangle(0.2, 0.2, 0.3)
        made += [course, slalom.World(course), slalom.Planner(course), costmap, body, slalom.Navigator(body, costmap)]
        made += [slalom.PredictedObstacle(np.zeros((1, 1, 5)), length=1, width=1), slalom.TrackedObject(1, (0, 0, 0), speed=1),
                 slalom.ObjectTracker(), slalom.Predictor()]
    return made


@pytest.mark.parametrize("each", objects(), ids=lambda each: type(each).__name__)
def test_pickles_and_copies_of_any_object_are_made_or_refused(each):
    ways = [lambda protocol=protocol: pickle.loads(pickle.dumps(each, protocol)) for protocol in range(6)]
    for make in [*ways, lambda: copy.copy(each), lambda: copy.deepcopy(each), each.__reduce__,
                 *(lambda protocol=protocol: each.__reduce_ex__(protocol) for protocol in range(6))]:
        try:
            repr(make())
        except (TypeError, RuntimeError, AttributeError, pickle.PicklingError) as error:
            assert "pickle" in str(error) or "solved again" in str(error)


def test_there_is_an_object_of_every_class():
    classes = {cls for module in filter(None, (slalom._slalom, slalom._driving)) for cls in vars(module).values()
               if isinstance(cls, type) and not issubclass(cls, Exception)}
    without = {slalom.AnyProblem, slalom.Controller, slalom.CompiledProblem,  # bases, and test_compiled.py
               getattr(slalom._slalom, "_View", None)}  # test_show.py
    assert classes - {type(each) for each in objects()} <= without


def test_copies_of_a_plan_stay_valid():
    controller = slalom.SvgMppi(slalom.CartPole(), horizon=8, samples=64, batches=1)
    plan = controller.solve([0, 0, 0.1, 0])
    arrays = plan.to_numpy()
    shapes = {"inputs": (8, 1), "states": (9, 4), "nominal": (8, 1), "variances": (8, 1), "samples": (64, 8, 1),
              "costs": (64,), "weights": (64,), "samples_collided": (64,), "guides": (plan.guides.shape[0], 8, 1)}
    assert {name: array.shape for name, array in arrays.items()} == shapes
    before = {name: array.copy() for name, array in arrays.items()}
    controller.solve([0, 0, 1.0, 0])
    assert all(np.array_equal(arrays[name], before[name]) and arrays[name].flags.writeable for name in arrays)
    with pytest.raises(RuntimeError, match="solved again"):
        plan.to_numpy()


def test_the_stubs_name_everything():
    names = set()
    for stub in FOLDER.glob("*.pyi"):
        names |= {node.name for node in ast.parse(stub.read_text()).body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(slalom.__all__) - {
        "CompileError", "Feedback", "Linearization", "MlpProblem", "Run", "SymptomWarning", "__version__", "linearize", "run", "show"} <= names
    assert "gradient_samples: int = ..." in (FOLDER / "_slalom.pyi").read_text()


USE = """
import numpy as np
import slalom.tuner
from slalom.mlp import Mlp

controller = slalom.SvgMppi(slalom.CartPole(track=3.0), horizon=10, input_min=-10, input_max=[10])
plan = controller.solve(np.zeros(4), elapsed=0.1)
size: float = plan.effective_sample_size
inputs: list[float] = plan.inputs[0].tolist()
terms: dict[str, float] = plan.cost_terms
total: float = slalom.run(slalom.CartPole(), controller, np.zeros(4), steps=3).costs.sum()
step = controller.problem.step([0, 0, 0, 0], [1.0])
gains: list[float] = slalom.linearize(controller.problem, step, [1.0]).state_jacobian.tolist()
near: list[float] = slalom.Feedback(controller).input_at(0.01, step).tolist()
walls = slalom.signed_distance(slalom.OccupancyGrid(np.zeros((3, 3), bool), resolution=0.1))
"""


def test_mypy_accepts_the_package_and_finds_mistakes(tmp_path):
    pytest.importorskip("slalom._driving")
    mypy = shutil.which("mypy", path="/usr/bin") or shutil.which("mypy")
    if not mypy:
        pytest.skip("mypy is missing (Debian: mypy)")
    mistakes = {"slalom.Mppi(slalom.CartPole(), sample=10)": "sample", "slalom.CartPole(tack=1)": "tack",
                "slalom.Mppi(slalom.CartPole()).solve([0]).input": "input", "x: str = plan.cost": "str"}
    program = tmp_path / "use.py"
    program.write_text(USE + "\n".join(mistakes) + "\n")
    run = subprocess.run([mypy, "--strict", "--python-executable", sys.executable, "--cache-dir", tmp_path, program],
                         capture_output=True, text=True, env={"MYPYPATH": str(FOLDER.parent), "PATH": "/usr/bin:/bin"})
    errors = [line for line in run.stdout.splitlines() if ": error:" in line]
    first = len(USE.splitlines()) + 1
    assert len(errors) == len(mistakes), run.stdout
    for line, (error, word) in enumerate(zip(errors, mistakes.values()), first):
        assert f"use.py:{line}: error" in error and word in error


def test_tensors_share_the_memory_of_the_solver():
    torch = pytest.importorskip("torch")
    from slalom.torch import on_tensors

    seen = []

    @on_tensors
    def tensor_dynamics(x, u):
        seen.append((u.data_ptr(), tuple(u.shape), u.dtype))
        return torch.stack([x[:, 0] + 0.1 * x[:, 1], x[:, 1] + 0.1 * u[:, 0]]).T

    @on_tensors
    def tensor_cost(x, u):
        return {"distance": x[:, 0] ** 2 + 0.1 * x[:, 1] ** 2, "effort": 0.1 * u[:, 0] ** 2}, x[:, 0] > 100

    kept = []

    def spied(x, u):
        kept.append(u.__array_interface__["data"][0])
        return tensor_dynamics(x, u)

    plans = [slalom.Mppi(problem, horizon=10, samples=128, seed=5).solve([1, 0])
             for problem in (point(dynamics=spied, cost=tensor_cost), point())]
    assert [data for data, *_ in seen] == kept and seen[0][1:] == ((128, 1), torch.float32)
    np.testing.assert_allclose(plans[0].inputs, plans[1].inputs, atol=1e-4)
    assert list(plans[0].cost_terms) == ["distance", "effort"]


def test_a_plan_is_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    for make in slalom.SvgMppi, slalom.Icem, slalom.SvMpc:
        controller = make(slalom.DifferentialDrive(), horizon=20, input_min=[-0.5, -2], input_max=[0.5, np.inf])
        controller.solve([0, 0, 0])
        plan = controller.solve([0, 0, 0], elapsed=0.1)
        figure = slalom.plot.plan(plan, ["x, m", "y, m", "yaw, rad"], ["speed, m/s", "turn, rad/s"])
        names = [axis.get_ylabel() for axis in figure.subfigs[0].axes]
        legend = [text.get_text() for text in figure.subfigs[1].axes[0].get_legend().get_texts()]
        assert names == ["speed, m/s", "turn, rad/s"] and legend == ["x, m", "y, m", "yaw, rad"]
        assert "state 2" in str([*map(str, slalom.plot.plan(plan).subfigs[1].axes[0].get_legend().get_texts())])
        figure.savefig(tmp_path / "plan.png")
        titles = [axis.get_title(loc="left") for part in figure.subfigs for axis in part.axes]
        assert len(titles) == 6 and titles[0].startswith("at a bound in ") and "effective sample size" in titles[4]
        at_bound = np.mean(np.abs(plan.inputs[:, 0]) == 0.5)
        assert slalom.plot.saturation(plan)[0] == pytest.approx(at_bound) and plan._repr_png_().startswith(b"\x89PNG")
        controller.solve([0, 0, 0], elapsed=0.1)
        assert plan._repr_png_() is None, "a notebook then shows that the plan is of an earlier solve"


def test_costs_far_above_the_others_do_not_hide_them_in_the_figure():
    pytest.importorskip("matplotlib")
    runs_away = point(cost=lambda x, u: np.where(u[:, 0] > 1.8, np.float32(1e25), u[:, 0] ** 2))
    plan = slalom.Mppi(runs_away, horizon=4).solve([0, 0])
    axis = slalom.plot.plan(plan).subfigs[1].axes[1]
    assert axis.get_xlim()[1] < 1000
    far = np.sum((plan.costs > 1e20) & np.isfinite(plan.costs))
    assert 0 < far and f" {far} beyond" in axis.get_title(loc="left")
