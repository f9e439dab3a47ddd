"""The calls of a problem's functions."""

import numpy as np
import pytest
import slalom
from test_controllers import linear


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
