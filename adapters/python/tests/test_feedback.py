import numpy as np
import pytest
import slalom

A, B = np.array([[1, 0.1], [0, 1]]), np.array([[0.0], [0.1]])
Q, R, P = np.diag([2.0, 0.5]), np.array([[0.3]]), np.diag([5.0, 1.0])


def linear(**changes):
    """A double integrator with a quadratic cost."""
    def dynamics(x, u):
        return x @ A.T.astype(x.dtype) + u @ B.T.astype(x.dtype)

    def cost(x, u):
        return {"state": np.einsum("ki,ij,kj->k", x, Q, x), "input": np.einsum("ki,ij,kj->k", u, R, u)}

    parts = dict(dynamics=dynamics, cost=cost, terminal_cost=lambda x: np.einsum("ki,ij,kj->k", x, P, x), states=2,
                 inputs=1, dt=0.1)
    return slalom.Problem(**{**parts, **changes})


def pendulum():
    def dynamics(x, u):
        rate = x[:, 1] + 0.02 * (9.81 * np.sin(x[:, 0]) + u[:, 0])
        return np.stack([x[:, 0] + 0.02 * rate, rate]).T

    def cost(x, u):
        return 0.02 * (10 * (1 - np.cos(x[:, 0])) + 0.1 * x[:, 1] ** 2 + 0.01 * u[:, 0] ** 2)

    return slalom.Problem(dynamics, cost, lambda x: (x[:, 1] ** 2 / 2 + 9.81 * (np.cos(x[:, 0]) - 1)) ** 2,
                          states=2, inputs=1, dt=0.02)


def test_differences_of_callables_agree_with_exact_derivatives():
    for x in [0.3, -0.2], [3.0, 1.5]:
        exact, differences = (slalom.linearize(p, x, [0.7]) for p in (slalom.Pendulum(), pendulum()))
        for name in "next", "state_jacobian", "input_jacobian", "state_gradient", "input_gradient", "cost":
            np.testing.assert_allclose(getattr(differences, name), getattr(exact, name), rtol=1e-8, atol=1e-9)
        for name in "state_hessian", "input_hessian", "cross_hessian":
            np.testing.assert_allclose(getattr(differences, name), getattr(exact, name), rtol=1e-5, atol=1e-6)
        assert exact.state_jacobian.shape == (2, 2) and exact.input_jacobian.shape == (2, 1)
        assert exact.cross_hessian.shape == (1, 2) and not exact.kink and not differences.kink
        ends = [slalom.expand_terminal_cost(p, x) for p in (slalom.Pendulum(), pendulum())]
        for name in "cost", "state_gradient", "state_hessian":
            np.testing.assert_allclose(getattr(ends[1], name), getattr(ends[0], name), rtol=1e-4, atol=1e-5)


def test_kinks_are_told():
    assert slalom.linearize(slalom.DifferentialDrive(goal_x=1, goal_y=2), [1, 2, 0], [1, 0]).kink
    bent = linear(cost=lambda x, u: np.abs(x[:, 0]), terminal_cost=None)
    assert slalom.linearize(bent, [0, 1], [0]).kink and not slalom.linearize(bent, [0.5, 1], [0]).kink
    end = slalom.expand_terminal_cost(bent, [0, 1])
    assert not end.kink and end.cost == 0 and not end.state_gradient.any()


def test_gains_are_those_of_the_riccati_recursion():
    controller = slalom.Mppi(linear(), horizon=15, samples=64)
    feedback = slalom.Feedback(controller)
    assert not feedback.gains.any() and feedback.gains.shape == (15, 1, 2)
    plan = controller.solve([1, 0])
    assert feedback.update(plan) is True
    value = P
    for k in reversed(range(15)):
        gain = -np.linalg.solve(R + B.T @ value @ B, B.T @ value @ A)
        np.testing.assert_allclose(feedback.gains[k], gain, rtol=1e-5)
        value = Q + A.T @ value @ (A + B @ gain)
    x = plan.states[4] + [0.01, -0.02]
    np.testing.assert_allclose(feedback.input_at(0.4, x), plan.inputs[4] + feedback.gains[4] @ [0.01, -0.02])
    assert not feedback.has_kink


def test_feedback_keeps_bounds():
    controller = slalom.Mppi(linear(), horizon=5, samples=64, input_min=-0.5, input_max=0.5)
    feedback = slalom.Feedback(controller)
    feedback.update(controller.solve([0, 0]))
    assert feedback.input_at(0, [-100, 0]) == pytest.approx(0.5)
    assert feedback.input_at(0, [100, 0]) == pytest.approx(-0.5)


def test_what_cannot_be_differentiated_is_rejected():
    with pytest.raises(TypeError, match="cost: returned float32 for float64 arguments"):
        slalom.linearize(linear(cost=lambda x, u: x[:, 0].astype(np.float32)), [0, 0], [0])
    with pytest.raises(ValueError, match="state: has 3 values, must have 2"):
        slalom.linearize(slalom.Pendulum(), [0, 0, 0], [0])
    controller = slalom.Mppi(slalom.Pendulum(), horizon=5, samples=64)
    feedback = slalom.Feedback(controller)
    with pytest.raises(ValueError, match="not one of the controller"):
        feedback.update(slalom.Mppi(slalom.CartPole(), horizon=5, samples=64).solve([0, 0, 0, 0]))
    plan = controller.solve([0, 0])
    controller.solve([0, 0])
    with pytest.raises(RuntimeError, match="solved again"):
        feedback.update(plan)


def optimum(start, steps):
    """The best inputs of the linear-quadratic problem, by the Riccati recursion."""
    value, gains = P, []
    for _ in range(steps):
        gains.insert(0, -np.linalg.solve(R + B.T @ value @ B, B.T @ value @ A))
        value = Q + A.T @ value @ (A + B @ gains[0])
    x, inputs = np.array(start, float), []
    for gain in gains:
        inputs.append(gain @ x)
        x = A @ x + B @ inputs[-1]
    return np.array(inputs)


def test_a_step_of_ilqr_solves_a_linear_quadratic_problem():
    controller = slalom.Mppi(linear(), horizon=15, samples=64, control_cost_discount=1)
    ilqr = slalom.Ilqr(controller, iterations=1)
    inputs = ilqr.improve([1, 0.5])
    np.testing.assert_allclose(inputs, optimum([1, 0.5], 15), rtol=1e-4, atol=1e-6)
    assert inputs.shape == (15, 1) and ilqr.iterations == 1 and ilqr.cost < ilqr.first_cost and not ilqr.has_kink
    assert controller.solve([1, 0.5], proposals=inputs).stats.weights[-1] > 0.01
    np.testing.assert_allclose(ilqr.improve([1, 0.5], elapsed=0.1)[0], optimum([1, 0.5], 15)[0], rtol=1e-4)


def test_ilqr_of_a_built_in_problem_keeps_bounds():
    controller = slalom.SvgMppi(slalom.CartPole(), horizon=40, input_min=-3, input_max=3)
    ilqr = slalom.Ilqr(controller, iterations=20)
    inputs = ilqr.improve([0, 0, 3.0, 0])
    assert np.abs(inputs).max() == 3 and ilqr.cost < ilqr.first_cost
    ilqr.start_from(np.zeros((0, 1)))
    assert ilqr.improve([0, 0, 3.0, 0]).shape == (40, 1)
    with pytest.raises(ValueError, match=r"inputs: must have the shape \(steps, 1\) with at most 40 steps"):
        ilqr.start_from(np.zeros((40, 2)))
    with pytest.raises(ValueError, match="state: has 1 values, must have 4"):
        ilqr.improve([0])
    with pytest.raises(ValueError, match="ilqr.iterations: 0 must be in"):
        slalom.Ilqr(controller, iterations=0)
    with pytest.raises(TypeError, match="controller must be a slalom.Controller"):
        slalom.Ilqr(slalom.CartPole())
