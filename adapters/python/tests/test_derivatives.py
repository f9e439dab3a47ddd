"""Derivatives of problems, and feedback between two plans."""

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
    for problem in slalom.CartPole(), linear():
        with pytest.raises(TypeError, match=r"has no derivatives: slalom.compile\(problem, derivatives=True\)"):
            slalom.linearize(problem, [0] * problem.states, [0])


def test_gains_are_those_of_the_regulator():
    controller = slalom.Mppi(slalom.compile(WAVE, derivatives=True, curve=0), horizon=8, input_max=5)
    feedback, plan = slalom.Feedback(controller), controller.solve([1, 0])
    assert not feedback.gains.any() and feedback.update(plan)
    A, V = np.array([[1, 0.1], [0, 1]]), np.diag([0.0, 6])
    for k in range(7, -1, -1):
        B = np.array([[0], [0.1 * (1 + k)]])
        K = -np.linalg.solve(0.2 + B.T @ V @ B, B.T @ V @ A)
        V = np.diag([2.0, 0]) + A.T @ V @ (A + B @ K)
        assert feedback.gains[k] == pytest.approx(K)
    change = np.array([0.01, -0.02])
    assert feedback.input_at(0, plan.states[0] + change) == pytest.approx(plan.inputs[0] + feedback.gains[0] @ change)
    assert feedback.input_at(0, [-1e6, 0]) == [5]
    half = feedback.input_at(0.15, (plan.states[1] + plan.states[2]) / 2)
    assert half == pytest.approx(plan.inputs[1]) and feedback.input_at(9, plan.states[8]) == pytest.approx(plan.inputs[7])
