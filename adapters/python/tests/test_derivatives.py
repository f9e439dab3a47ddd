"""Derivatives of problems, feedback between two plans, the calls of a problem's functions, and maps."""

import numpy as np
import pytest
import slalom
from test_controllers import linear

WAVE = """
struct Wave {
  template <class T> struct State { T place, speed; };
  static constexpr int inputs = 1;
  double dt = 0.1, curve = 1;
  template <class T> State<T> step(const State<T>& x, const slalom::Input<T, 1>& u, int k) const {
    return {x.place + T(dt) * x.speed, x.speed + T(dt) * (T(curve) * slalom::sin(x.place) + T(1 + k) * u[0])};
  }
  template <class T> T stage_cost(const State<T>& x, const slalom::Input<T, 1>& u) const {
    return slalom::square(x.place) + T(0.1) * slalom::square(u[0]) + T(curve) * slalom::abs(x.speed) * u[0];
  }
  template <class T> T terminal_cost(const State<T>& x) const { return T(3) * slalom::square(x.speed); }
};
"""


def test_derivatives_are_exact():
    wave = slalom.compile(WAVE, derivatives=True)
    around = slalom.linearize(wave, [0.4, -1.5], [0.7], k=2)
    assert around.next == pytest.approx(wave.step([0.4, -1.5], [0.7], k=2))
    assert around.state_jacobian == pytest.approx(np.array([[1, 0.1], [0.1 * np.cos(0.4), 1]]))
    assert around.input_jacobian == pytest.approx(np.array([[0], [0.3]]))
    assert around.cost == pytest.approx(0.16 + 0.049 + 1.05) and around.gradient == pytest.approx([0.8, -0.7, 0.14 + 1.5])
    assert around.hessian == pytest.approx(np.array([[2, 0, 0], [0, 0, -1], [0, -1, 0.2]])) and around.kink == 0
    assert slalom.linearize(wave, [0.4, 0], [0.7]).kink == 1
    end = slalom.linearize(wave, [0.4, -1.5])
    assert end.cost == 6.75 and end.gradient.tolist() == [0, -9] and end.hessian.tolist() == [[0, 0], [0, 6]]
    cart = slalom.compile(slalom.CartPole(track=3), derivatives=True)
    assert slalom.linearize(cart, [0, 0, 0.1, 0], [2]).next == pytest.approx(slalom.CartPole().step([0, 0, 0.1, 0], [2]))
    for problem in slalom.CartPole(), slalom.Problem(rollout=lambda x, u: np.zeros(len(u)), states=1, inputs=1):
        with pytest.raises(TypeError, match=r"has no derivatives: slalom.compile\(problem, derivatives=True\)"):
            slalom.linearize(problem, [0] * problem.states, [0])


def wave(curve=1.0):
    def dynamics(x, u, k):
        return np.stack([x[:, 0] + 0.1 * x[:, 1], x[:, 1] + 0.1 * (curve * np.sin(x[:, 0]) + (1 + k) * u[:, 0])]).T

    def cost(x, u):
        return {"place": x[:, 0] ** 2, "effort": 0.1 * u[:, 0] ** 2, "both": curve * np.abs(x[:, 1]) * u[:, 0]}, x[:, 0] > 9

    return slalom.Problem(dynamics, cost, lambda x: 3 * x[:, 1] ** 2, states=2, inputs=1, dt=0.1)


def test_derivatives_of_callables_are_those_of_the_struct():
    for inputs in [0.7], []:
        parts = zip(*(slalom.linearize(each, [0.4, -1.5], inputs, k=2) for each in (wave(), slalom.compile(WAVE, derivatives=True))))
        for mine, exact in parts:
            np.testing.assert_allclose(mine, exact, rtol=1e-6, atol=1e-6)
    without = slalom.Problem(wave().dynamics, wave().cost, states=2, inputs=1)
    assert not slalom.linearize(without, [0.4, -1.5]).gradient.any()
    with pytest.raises(TypeError, match=r"Problem.cost: returned float32 for arrays of float64; must compute in float64"):
        slalom.linearize(linear(cost=lambda x, u: np.float32(x[:, 0])), [0, 0], [0])


@pytest.mark.parametrize("make", [lambda: slalom.compile(WAVE, derivatives=True, curve=0), lambda: wave(curve=0)])
def test_gains_are_those_of_the_regulator(make):
    controller = slalom.Mppi(make(), horizon=8, input_max=5)
    feedback, plan = slalom.Feedback(controller), controller.solve([1, 0])
    assert not feedback.gains.any() and feedback.update(plan)
    A, V = np.array([[1, 0.1], [0, 1]]), np.diag([0.0, 6])
    for k in range(7, -1, -1):
        B = np.array([[0], [0.1 * (1 + k)]])
        K = -np.linalg.solve(0.2 + B.T @ V @ B, B.T @ V @ A)
        V = np.diag([2.0, 0]) + A.T @ V @ (A + B @ K)
        assert feedback.gains[k] == pytest.approx(K, rel=1e-5)
    change = np.array([0.01, -0.02])
    assert feedback.input_at(0, plan.states[0] + change) == pytest.approx(plan.inputs[0] + feedback.gains[0] @ change)
    assert feedback.input_at(0, [-1e6, 0]) == [5]
    half = feedback.input_at(0.15, (plan.states[1] + plan.states[2]) / 2)
    assert half == pytest.approx(plan.inputs[1]) and feedback.input_at(9, plan.states[8]) == pytest.approx(plan.inputs[7])


@pytest.mark.parametrize("method, rollouts", [("mppi", 1), ("svg_mppi", 4), ("reverse_mppi", 20), ("sv_mpc", 6),
                                              ("cem", 5), ("icem", 5), ("dial_mpc", 2)])
def test_a_solve_calls_callables_as_often_as_the_page_says(method, rollouts):
    calls, costs = [], []
    plain = linear()

    def dynamics(x, u):
        calls.append(len(x))
        return plain.dynamics(x, u)

    def cost(x, u):
        costs.append(len(x))
        return plain.cost(x, u)

    problem = linear(dynamics=dynamics, cost=cost)
    for threads in 1, 3:
        controller = slalom.Controller(method, problem, horizon=7, samples=1024, threads=threads)
        controller.solve([1, 0])
        calls.clear()
        costs.clear()
        controller.solve([1, 0], elapsed=0.1)
        assert len(calls) == 7 * rollouts and sum(costs) == sum(calls)
        assert len(costs) == sum(1 if size <= 512 else 7 for size in calls[::7])
        assert method != "svg_mppi" or len(costs) == rollouts


def test_callables_may_take_the_index_of_the_step():
    seen = []

    def dynamics(x, u, k):
        return x + np.float32(k) * u

    def cost(x, u, k):
        seen.append(k)
        return (x[:, 0] - k) ** 2

    problem = slalom.Problem(dynamics, cost, states=1, inputs=1, dt=0.1)
    plan = slalom.Mppi(problem, horizon=4, samples=64).solve([0])
    assert seen[:4] == [0, 1, 2, 3]
    inputs = plan.inputs[:, 0]
    assert plan.states[:, 0] == pytest.approx(np.cumsum([0, *(np.arange(4) * inputs)]))
    assert plan.cost == pytest.approx(np.sum((plan.states[:4, 0] - np.arange(4)) ** 2))
    assert problem.step([1], [2], k=3) == pytest.approx([7])
    spring = linear(cost=lambda x, u, k=5.0: k * x[:, 0] ** 2)  # a default: not the index
    assert slalom.Mppi(spring, horizon=4).solve([1, 0]).cost_terms["stage"] > 5


def test_a_field_interpolates_its_samples():
    samples = np.arange(12.0).reshape(3, 4)
    field = slalom.Field(samples, resolution=0.5, origin=(1, 2))
    assert field.shape == (3, 4) and field.resolution == 0.5 and field.origin == (1, 2, 0)
    assert repr(field) == "<slalom.Field 3 x 4 of 0.5 m>"
    columns, rows = np.meshgrid(np.arange(4), np.arange(3))
    np.testing.assert_allclose(field.value(1.25 + 0.5 * columns, 2.25 + 0.5 * rows), samples)
    value, dx, dy = field.value_and_gradient(1.5, 2.5)
    assert (value, dx, dy) == pytest.approx((2.5, 2, 8)) and field.relative_to(1, 2).value(0.5, 0.5) == pytest.approx(2.5)


def test_a_field_of_a_function_is_that_function():
    field = slalom.Field.from_function(lambda x, y: 2 * x - y, width=30, height=20, resolution=0.1, origin=(-1, -1, 0.2))
    x, y = np.array([0.1, 0.4]), np.array([0.2, -0.1])
    for dtype in np.float64, np.float32:
        value, dx, dy = field.value_and_gradient(x.astype(dtype), y.astype(dtype))
        assert value.dtype == dx.dtype == dy.dtype == dtype
        np.testing.assert_allclose(value, 2 * x - y, atol=1e-4)
        np.testing.assert_allclose(dx, 2, rtol=1e-3)
        np.testing.assert_allclose(dy, -1, rtol=1e-3)


def test_signed_distance_of_occupancy():
    cells = np.zeros((20, 30), bool)
    cells[:, 10] = True
    field = slalom.signed_distance(slalom.OccupancyGrid(cells, 0.1), outside_is_obstacle=False)
    assert field.value(0.55, 1.0) == pytest.approx(0.45)  # the wall begins at x = 1 m
    assert field.value(1.05, 1.0) == pytest.approx(-0.05)


def test_a_ros_map_is_loaded(tmp_path):
    (tmp_path / "hall.pgm").write_bytes(b"P5\n3 2\n255\n" + bytes([0, 254, 254, 254, 205, 254]))
    (tmp_path / "hall.yaml").write_text("image: hall.pgm\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\n"
                                        "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    grid = slalom.load_ros_map(str(tmp_path / "hall.yaml"))
    assert grid.cells.tolist() == [[0, -1, 0], [100, 0, 0]]  # the first row of an image is the topmost
    assert grid.resolution == 0.2 and grid.origin == (1, 2, 0)
    with pytest.raises(slalom.IoError, match="missing.yaml"):
        slalom.load_ros_map(str(tmp_path / "missing.yaml"))


@pytest.mark.parametrize("make, text", [(lambda: slalom.Field([1.0, 2.0], 0.1), "has 1 dimensions, must have 2"),
    (lambda: slalom.Field([[1.0, np.nan]], 0.1), "row 0, column 1: nan: must be a finite float32 value"),
    (lambda: slalom.Field([[1.0]], 0), "field.resolution: 0: must be finite and above 0"),
    (lambda: slalom.Field([[1.0]], 1, (1,)), "origin: has 1 values, must have 2 or 3"),
    (lambda: slalom.Field.from_function(lambda x, y: x[0], 3, 2, 1), r"must return an array of shape \(2, 3\)"),
    (lambda: slalom.Field.from_function(lambda x, y: x, 0, 2, 1), "0 x 2 cells must be at least 1 x 1"),
    (lambda: slalom.Field([[1.0]], 1).value([1, 2], [1, 2, 3]), "x, y: must have the same shape"),
    (lambda: slalom.OccupancyGrid([[0, 101]], 1), r"101 must be in \[-1, 100\]"),
    (lambda: slalom.OccupancyGrid([0, 100], 1), "has 1 dimensions, must have 2"),
    (lambda: slalom.signed_distance(slalom.OccupancyGrid([[0]], -1)), "map: resolution -1 must be finite and above 0"),])
def test_what_is_no_map_is_rejected(make, text):
    with pytest.raises(ValueError, match=text):
        make()
