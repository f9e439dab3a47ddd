"""Problems that are compiled at run time, networks as problems, and batches of solves."""

import copy
import pickle
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import slalom
from slalom.mlp import Mlp

ROOT = Path(__file__).resolve().parents[3]
README = (ROOT / "README.md").read_text()
PENDULUM = re.search(r"```cpp\n#include <slalom/slalom.hpp>\n\n(struct Pendulum.*?\n};)", README, re.S)[1]
needs_compiler = pytest.mark.skipif(not shutil.which("c++"), reason="no C++ compiler")


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder / "slalom"


@needs_compiler
def test_the_pendulum_of_the_readme_is_compiled_once(cache):
    pendulum = slalom.compile(PENDULUM)
    controller = slalom.SvgMppi(pendulum, horizon=60, samples=2048, input_min=-5, input_max=5)
    plan = controller.solve([0.1, 0], elapsed=0.02)
    assert plan.ok and plan.states.shape == (61, 2) and list(plan.cost_terms) == ["stage", "terminal"]
    x = np.array([0.5, 0.2])
    rate = 0.2 + 0.02 * (9.81 * np.sin(0.5) + 1)
    assert pendulum.step(x, [1.0]) == pytest.approx([0.5 + 0.02 * rate, rate])
    compiled = [(file, file.stat().st_mtime_ns) for file in cache.iterdir()]
    slalom.compile(PENDULUM)
    assert len(compiled) == 1 and compiled == [(file, file.stat().st_mtime_ns) for file in cache.iterdir()]


@needs_compiler
def test_a_step_of_a_compiled_problem_gets_its_index():
    walk = slalom.compile("""struct Walk {
      template <class T> struct State { T x; };
      static constexpr int inputs = 1;
      template <class T> State<T> step(const State<T>& x, const slalom::Input<T, 1>& u, int k) const {
        return {x.x + T(k) * u[0]};
      }
      template <class T> T stage_cost(const State<T>& x, const slalom::Input<T, 1>&) const { return x.x * x.x; }
    };""")
    assert [walk.step([1], [2], k)[0] for k in (0, 3)] == [1, 7]


@needs_compiler
def test_parameters_of_a_compiled_problem():
    source = PENDULUM.replace("double dt = 0.02;", "double dt = 0.02, weight{1}; std::array<double, 2> pair{1, 2};"
                              "double input_min = -5, input_max = 5, input_levels = 3;")
    assert source != PENDULUM
    pendulum = slalom.compile(source, dt=0.01)
    assert pendulum.dt == 0.01 and pendulum.parameters == {"dt": 0.01, "weight": 1, "pair": [1, 2],
                                                            "input_min": -5, "input_max": 5, "input_levels": 3}
    controller = slalom.Mppi(pendulum, horizon=20, temperature=0.1, variance=16)
    plans = [controller.solve([0.3, 0], elapsed=0.01).inputs.copy() for _ in range(3)]
    assert np.isin(plans, [-5, 0, 5]).all() and len(np.unique(plans)) > 1 and controller.options["variance"] == 16
    controller.problem.pair = [3, 4]
    assert controller.problem.pair == [3, 4] and pendulum.pair == [1, 2]
    assert isinstance(controller.problem, slalom.CompiledProblem) and "weight" in dir(controller.problem)
    for each in copy.copy(controller).problem, pickle.loads(pickle.dumps(controller.problem)):
        assert each.pair == [3, 4] and each.dt == 0.01
    with pytest.raises(AttributeError, match="no parameter 'mass'; it has: dt, weight, pair, input_min"):
        controller.problem.mass = 3
    with pytest.raises(ValueError, match="pair: has 1 values, must have 2"):
        controller.problem.pair = 3


@needs_compiler
def test_headers_are_compiled_again_when_they_change(tmp_path, cache):
    header, part = tmp_path / "pendulum.hpp", tmp_path / "gravity.hpp"
    header.write_text('#include "gravity.hpp"\nnamespace mine {\n' + PENDULUM.replace("9.81", "gravity") + "\n}\n")
    speeds = []
    for gravity in 9.81, 1.62:
        part.write_text(f"static constexpr double gravity = {gravity};\n")
        speeds.append(slalom.compile(header, "mine::Pendulum").step([0.5, 0], [0])[1])
    assert speeds == pytest.approx([0.02 * g * np.sin(0.5) for g in (9.81, 1.62)])


@needs_compiler
def test_mistakes_of_compiled_problems_have_the_compilers_words(monkeypatch):
    two = "".join(f"struct {name} {{ static constexpr int inputs = 1; }};" for name in ("One", "Two"))
    for source, error, words in [
            (PENDULUM.replace("stage_cost", "cost"), slalom.CompileError, "slalom: the problem needs .*stage_cost"),
            (PENDULUM.replace("x.rate", "x.speed", 1), slalom.CompileError, "<source>:.*error: .*speed"),
            ("struct Nothing { int inputs; };", ValueError, "no problem: a struct"),
            (two, ValueError, "must be one of One, Two"), ("no_such_header.hpp", FileNotFoundError, "")]:
        with pytest.raises(error, match=words):
            slalom.compile(source)
    monkeypatch.setenv("CXX", "no-such-compiler")
    with pytest.raises(slalom.CompileError, match="no C.. compiler found .no-such-compiler.*set CXX"):
        slalom.compile(PENDULUM)


def network(activation="tanh", residual=True):
    random = np.random.default_rng(0)
    layers = [(random.normal(size=(16, 3)), random.normal(size=16)), (random.normal(size=(2, 16)) / 16, np.zeros(2))]
    return Mlp(layers, activation, input_mean=[0.1, 0.2, 0], input_scale=[1, 2, 1], output_scale=[0.5, 1], residual=residual)


PARTS = {"goal": [1, 0], "state_weights": [1, 0.1], "terminal_weights": 2, "input_weights": 0.01, "dt": 0.1,
         "input_min": -2, "input_max": 2}


@needs_compiler
@pytest.mark.parametrize("activation", ["tanh", "relu", "softplus", "silu"])
def test_a_network_as_a_problem_is_that_of_callables(activation):
    mlp = network(activation, residual=activation != "relu")

    def cost(x, u):
        away = x - np.float32([1, 0])
        return away[:, 0] ** 2 + np.float32(0.1) * away[:, 1] ** 2 + np.float32(0.01) * u[:, 0] ** 2

    callables = slalom.Problem(lambda x, u: mlp(np.concatenate([x, u], axis=1)), cost, lambda x: 2 * np.sum((x - np.float32([1, 0])) ** 2, 1),
                               states=2, inputs=1, dt=0.1, input_min=-2, input_max=2)
    compiled = slalom.MlpProblem(mlp, **PARTS)
    plans = [slalom.Mppi(p, horizon=12, samples=200).solve([0.2, -0.3]) for p in (compiled, callables)]
    assert np.allclose(plans[0].costs, plans[1].costs, rtol=1e-4) and np.allclose(plans[0].inputs, plans[1].inputs, atol=1e-4)
    assert plans[0].cost == pytest.approx(plans[1].cost, rel=1e-5)
    assert np.allclose(compiled.step([0.2, -0.3], [1]), callables.step([0.2, -0.3], [1]), atol=1e-5)


@needs_compiler
def test_a_network_as_a_problem_goes_round_discs_and_is_changed_between_solves():
    steps = Mlp([(np.float32([[0, 0, 0.1, 0], [0, 0, 0, 0.1]]), np.zeros(2))], residual=True)  # a point that is moved
    problem = slalom.MlpProblem(steps, goal=[2, 0], state_weights=1, terminal_weights=10, discs=[(1, 0.05, 0.4)],
                                disc_weight=100, dt=0.1, input_min=-1, input_max=1)
    controller = slalom.SvgMppi(problem, horizon=40)
    plan = controller.solve([0, 0])
    assert not plan.collided and 0 < plan.collided_share < 1 and problem.collides([1, 0]) and not problem.collides([0, 0])
    controller.problem.discs = [(9, 9, 0.1)]
    controller.problem.goal = [0, 2]
    assert controller.solve([0, 0]).collided_share == 0 and problem.discs == [1, 0.05, 0.4]
    again = pickle.loads(pickle.dumps(problem))
    assert again.discs == problem.discs and again.goal == [2, 0] and "network=<slalom.mlp.Mlp 4 -> 2" in repr(again)
    assert again.step([0, 0], [1, 0]) == pytest.approx([0.1, 0])


LEARNED = """#include <slalom/maps/field.hpp>
struct Learned {
  template <class T> struct State { T x, y; };
  static constexpr int inputs = 1;
  slalom::Mlp<3, 2> network;
  slalom::maps::Field height;
  double dt = 0.1;
  template <class T> State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) const {
    const auto next = network(x.x, x.y, u[0]);
    return {next[0], next[1]};
  }
  template <class T> T stage_cost(const State<T>& x, const slalom::Input<T, 1>&) const { return height.value(x.x, x.y); }
};"""


@needs_compiler
def test_networks_and_fields_of_a_struct_are_set_by_keyword_attribute_or_file(tmp_path):
    mlp, slope = network(), slalom.Field.from_function(lambda x, y: x * x + y, 20, 20, 0.2, (-2, -2))
    mlp.save(tmp_path / "network.npz")
    (tmp_path / "map.pgm").write_bytes(b"P5\n2 1\n255\n\0\xfe")
    (tmp_path / "map.yaml").write_text("image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
                                       "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    problem = slalom.compile(LEARNED, network=mlp, height=slope)
    expected = mlp(np.array([[0.2, -0.3, 1]]))[0]
    assert problem.network is mlp and problem.step([0.2, -0.3], [1]) == pytest.approx(expected, abs=1e-5)
    assert problem.predict([0.2, -0.3], [[1]])[1] == pytest.approx(slope.value(0.2, -0.3))
    empty = slalom.compile(LEARNED)
    assert empty.parameters == {"network": None, "height": None, "dt": 0.1}
    with pytest.raises(ValueError, match="compile: the member 'network' is empty: set it"):
        slalom.Mppi(empty, horizon=3).solve([0, 0])
    empty.network, empty.height = tmp_path / "network.npz", str(tmp_path / "map.yaml")
    assert empty.step([0.2, -0.3], [1]) == pytest.approx(expected, abs=1e-5)
    for each in empty, copy.copy(slalom.Mppi(empty, horizon=3)).problem, pickle.loads(pickle.dumps(empty)):
        assert slalom.Mppi(each, horizon=3).solve([0, 0]).ok and each.predict([1.5, 0.5], [[0]])[1] == pytest.approx(0.5)
    for name, value, error, text in [("network", 3, TypeError, "network: 3 must be a slalom.mlp.Mlp or the file of one"),
                                     ("network", Mlp([(np.zeros((2, 2)), np.zeros(2))]), ValueError, "inputs"),
                                     ("height", 3, TypeError, "height: .*int.* has the wrong form")]:
        with pytest.raises(error, match=text):
            setattr(problem, name, value)


@needs_compiler
def test_a_network_as_a_problem_looks_up_maps_as_callables_do():
    mlp, occupied = network(), np.zeros((40, 40), bool)
    occupied[:, 24] = True
    walls = slalom.signed_distance(slalom.OccupancyGrid(occupied, 0.1, (-2, -2)))
    slope = slalom.Field.from_function(lambda x, y: x * x + y, 20, 20, 0.2, (-2, -2))

    def cost(x, u):
        hit = walls.value(x[:, 0], x[:, 1]) < 0.2
        return 3 * slope.value(x[:, 0], x[:, 1]) + np.where(hit, 50, 0), hit

    callables = slalom.Problem(lambda x, u: mlp(np.concatenate([x, u], axis=1)), cost, lambda x: cost(x, None), states=2,
                               inputs=1, input_min=-2, input_max=2)
    compiled = slalom.MlpProblem(mlp, walls=walls, clearance=0.2, disc_weight=50, field=slope, field_weight=3,
                                 input_min=-2, input_max=2)
    plans = [slalom.Mppi(p, horizon=12, samples=200).solve([0.2, -0.3]) for p in (compiled, callables)]
    assert np.allclose(plans[0].costs, plans[1].costs, rtol=1e-3) and plans[0].collided_share == plans[1].collided_share
    assert compiled.collides([0.3, 0]) and not compiled.collides([0, 0])


@needs_compiler
@pytest.mark.parametrize("make, error, text", [
    (lambda: slalom.MlpProblem(network(), walls=3), TypeError, "walls: .*int.* has the wrong form"),
    (lambda: slalom.MlpProblem(3), TypeError, "must be a slalom.mlp.Mlp"),
    (lambda: slalom.MlpProblem(Mlp([(np.zeros((2, 2)), np.zeros(2))])), ValueError, "maps 2 values to 2, must map"),
    (lambda: slalom.MlpProblem(network(), goal=[1, 2, 3]), ValueError, "goal: has 3 values, must have 1 or 2"),
    (lambda: slalom.MlpProblem(network(), gaol=1), TypeError, "unexpected keyword argument 'gaol'"),
    (lambda: slalom.Mppi(slalom.MlpProblem(network(), dt=-1)), ValueError, "-1.* must be finite and at least 0"),])
def test_mistakes_of_networks_as_problems(make, error, text):
    with pytest.raises(error, match=text):
        make()


def test_a_batch_of_solves_gives_the_plans_of_single_solves():
    one = slalom.Mppi(slalom.Pendulum(), horizon=10, samples=128, input_min=-5, input_max=5)
    states = [[0.1 * i, 0] for i in range(7)]
    for threads in 1, 2:
        batch, single = ([copy.copy(one) for _ in states] for _ in range(2))
        for _ in range(2):  # the second solve starts from each controller's own last plan
            plans = slalom.solve_batch(batch, states, elapsed=0.02, threads=threads)
            for plan, controller, x in zip(plans, single, states):
                assert np.array_equal(plan.inputs, controller.solve(x, elapsed=0.02).inputs)
    for many, error, words in [((batch, states[:1], 0), ValueError, "states: has 1 states, must have 7, one for each controller"),
                               ((batch, states, -1), ValueError, "elapsed: -1.* must be finite"),
                               (([one, one], states[:2], 0), RuntimeError, "another thread is using it")]:
        with pytest.raises(error, match=words):
            slalom.solve_batch(*many)


def test_callables_of_a_batch_run_on_one_thread_and_their_exceptions_leave_it():
    threads = set()

    def cost(x, u):
        threads.add(threading.get_ident())
        if x[0, 0] > 1:
            raise ArithmeticError("too far")
        return x[:, 0] ** 2

    problem = slalom.Problem(lambda x, u: x + u, cost, states=1, inputs=1)
    batch = [slalom.Mppi(problem, horizon=3, samples=64, variance=1e-12) for _ in range(16)]
    with pytest.raises(ArithmeticError, match="too far"):
        slalom.solve_batch(batch, [[0.5]] * 15 + [[2]], threads=4)
    assert slalom.solve_batch(batch, [[0.5]] * 16, threads=4)[15].ok and threads == {threading.get_ident()}


def test_the_package_needs_no_compiler_to_be_imported():
    subprocess.run([sys.executable, "-c", "import slalom; slalom.Mppi(slalom.Pendulum())"], check=True,
                   env={"PATH": "/nowhere", "PYTHONPATH": str(Path(slalom.__file__).parents[1])})
