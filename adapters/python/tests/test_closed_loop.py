"""Drives in closed loop, whole rollouts as a problem, and environments of gymnasium."""

import numpy as np
import pytest
import slalom
import slalom.ros
from test_controllers import cost, dynamics, linear

LIMITS = [{}, {"input_rate_max": 3}, {"input_min": -1, "input_max": 1, "input_levels": 3}]


def rollout(x, u):
    """The rollouts of `linear`."""
    states, total = [np.repeat(x[None].astype(u.dtype), len(u), axis=0)], 0
    for k in range(u.shape[1]):
        total = total + cost(states[-1], u[:, k])
        states.append(dynamics(states[-1], u[:, k]))
    return total, np.stack(states, axis=1)


def whole(**changes):
    return slalom.Problem(states=2, inputs=1, dt=0.1, **{"rollout": rollout, **changes})


def test_a_drive_is_the_loop_that_everybody_writes():
    other, controller = (slalom.Mppi(linear(), horizon=10, seed=3) for _ in range(2))
    drive, x = slalom.run(linear(), other, [1, 0], 5), np.array([1.0, 0.0])
    for k in range(5):
        u = controller.solve(x, elapsed=0.1 if k else 0).inputs[0]
        assert np.array_equal(drive.inputs[k], u) and drive.costs[k] == pytest.approx(cost(x[None], u[None])[0])
        x = controller.problem.step(x, u)
        assert np.array_equal(drive.states[k + 1], x)
    assert drive.times.min() > 0 and len(drive.times) == 5 and "5 steps" in repr(drive)
    assert slalom.run(linear(), lambda x: [-x[0]], [1, 0], 2, plant=lambda x, u: x + u).states.tolist() == [[1, 0], [0, -1], [0, -1]]
    pytest.importorskip("pandas")
    frame = drive.frame()
    assert frame.index[3] == pytest.approx(0.3) and len(frame) == 6
    assert frame["state 1"].tolist() == drive.states[:, 1].tolist() and np.isnan(frame["input 0"].iloc[-1])


@pytest.mark.parametrize("arguments, text", [
    (([1], 2), r"x0: \[1.\] must be 2 finite numbers"), (([1, 0], 2, lambda x, u: x[:1]), "plant: step 0: state: "),
    (([1, 0], 2, lambda x, u: x * np.nan), r"plant: step 0: state: \[nan nan\] must be")])
def test_mistakes_of_a_drive_are_named(arguments, text):
    with pytest.raises(ValueError, match=text):
        slalom.run(linear(), slalom.Mppi(linear(), horizon=3), *arguments)


def test_a_loop_for_ros_is_safe_where_no_plan_can_be_trusted():
    loop = slalom.ros.Loop(slalom.Mppi(linear(), horizon=5), safe=[0.25], deadline=1)
    assert loop.command(1) == 0.25 and loop.why == "no state yet"
    for state, stamp, now, why in [([1, 0], 1, 1.05, ""), ([1, 0], 1, 1.2, "the newest state is 0.20 s old"), ([1, 0], 1.3, 1.3, ""),
                                   ([1, 0], 3, 2, "the newest state is -1.00 s old"), ([np.nan, 0], 1.35, 1.35, "non_finite_state")]:
        loop.hear(state, stamp)
        assert (loop.command(now) == 0.25) == bool(why) and loop.why == why
    loop.hear([1, 0], 1.4)
    loop.deadline = 1e-9
    assert loop.command(1.4) != 0.25 and loop.plan.status == "deadline"
    walled = slalom.ros.Loop(slalom.Mppi(linear(cost=lambda x, u: (x[:, 0] ** 2, x[:, 0] > 0)), horizon=5), safe=[0.25], deadline=1)
    walled.hear([1, 0], 0)
    assert walled.command(0) == 0.25 and walled.why == "all_collided" and walled.plan.collided


@pytest.mark.parametrize("limits", LIMITS)
@pytest.mark.parametrize("method", ["mppi", "svg_mppi"])
def test_whole_rollouts_plan_as_dynamics_and_costs(limits, method):
    one, other = (slalom.Controller(method, each, horizon=10, samples=500, seed=3) for each in (whole(**limits), linear(**limits)))
    for x in [1, 0], [0.9, -0.2], [0.8, -0.3]:
        plans = [each.solve(x, elapsed=0.1) for each in (one, other)]
        np.testing.assert_allclose(plans[0].inputs, plans[1].inputs, atol=1e-3)
        np.testing.assert_allclose(plans[0].states, plans[1].states, atol=1e-3)
        assert plans[0].cost == pytest.approx(plans[1].cost, rel=1e-4) and plans[0].cost_terms == {"total": plans[0].cost}
    assert one.problem.step([1, 0], [2]) == pytest.approx(other.problem.step([1, 0], [2]))


def test_a_rollout_may_tell_costs_alone():
    plan = slalom.Mppi(whole(rollout=lambda x, u: rollout(x, u)[0]), horizon=10, samples=100).solve([1, 0])
    assert plan.ok and plan.cost > 0
    with pytest.raises(ValueError, match=r"a pair \(costs, states \[K, T \+ 1, states\]\)"):
        plan.states
    with pytest.raises(ValueError, match="a pair"):
        plan.controller.problem.step([1, 0], [0])


@pytest.mark.parametrize("changes, error, text", [({"rollout": 3}, ValueError, "rollout: must be callable or None"),
    ({"cost": cost}, ValueError, "rollout: takes the place of dynamics, cost and terminal_cost"),
    ({"input_levels": 3}, ValueError, "input_levels: needs input_min and input_max"),
    ({"input_levels": 1.5, "input_min": 0, "input_max": 1}, ValueError, "input_levels: 1.5.* must be 0 or a whole number"),
    ({"rollout": lambda x, u: np.zeros(3)}, ValueError, r"rollout: returned shape \(3,\), must be \(64,\)"),
    ({"rollout": lambda x, u: (np.zeros(len(u)), x)}, ValueError, r"rollout: states: returned shape \(2,\), must be \(64, 5, 2\)"),
    ({"rollout": None}, ValueError, "dynamics: must be callable")])
def test_mistakes_of_rollouts_and_levels_are_named(changes, error, text):
    with pytest.raises(error, match=text):
        slalom.Mppi(whole(**changes), horizon=4, samples=64).solve([0, 0])


def test_inputs_in_levels_have_the_mean_of_the_plan():
    problem = linear(cost=lambda x, u: (x[:, 1] - np.float32(0.3)) ** 2, input_min=-1, input_max=1, input_levels=3)
    drive = slalom.run(problem, slalom.Mppi(problem, horizon=20, temperature=0.01), [0, 0], 60)
    assert np.isin(drive.inputs, [-1, 0, 1]).all() and abs(drive.states[-20:, 1].mean() - 0.3) < 0.06


@pytest.mark.parametrize("name, horizon, least", [("Pendulum-v1", 20, -200), ("InvertedPendulum-v5", 8, 20)])
def test_an_environment_is_driven_by_its_own_model(name, horizon, least):
    gymnasium = pytest.importorskip("gymnasium")
    if "v5" in name:
        pytest.importorskip("mujoco")
    from slalom.gymnasium import Problem, episode

    env, problem = gymnasium.make(name), Problem(gymnasium.make(name))
    drives = [episode(env, slalom.Mppi(problem, horizon=horizon, samples=40), seed=1, steps=25) for _ in range(2)]
    assert np.array_equal(drives[0].inputs, drives[1].inputs) and -drives[0].costs.sum() > least
    assert problem.step(drives[0].states[3], drives[0].inputs[3]) == pytest.approx(drives[0].states[4], abs=1e-6)


def test_an_environment_without_an_attribute_state_is_its_numbers():
    gymnasium = pytest.importorskip("gymnasium")
    from slalom.gymnasium import Problem, episode

    class Walk(gymnasium.Env):
        action_space = gymnasium.spaces.Box(-1, 1, (1,))

        def reset(self, seed=None, options=None):
            self.place, self.steps, self.name = 3.0, 0, "walk"
            return self.place, {}

        def step(self, action):
            self.place, self.steps = self.place + float(action[0]), self.steps + 1
            return self.place, -abs(self.place), False, self.steps == 6, {}

    drive = episode(Walk(), slalom.Mppi(Problem(Walk()), horizon=6, samples=64))
    assert drive.states[0].tolist() == [3, 0] and drive.states[-1, 1] == 6 and abs(drive.states[-1, 0]) < 0.5


def test_a_problem_is_an_environment():
    pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env
    from slalom.gymnasium import Env, episode

    problem = linear(input_min=-2, input_max=2)
    env = Env(problem, lambda random: random.normal(size=2), steps=5)
    check_env(env, skip_render_check=True)
    assert np.array_equal(env.reset(seed=4)[0], env.reset(seed=4)[0])
    x = env.reset(seed=4)[0]
    following, reward, *ends, _ = env.step(np.array([0.5]))
    assert reward == pytest.approx(-cost(x[None], np.array([[0.5]]))[0]) and ends == [False, False]
    assert following == pytest.approx(problem.step(x, [0.5]))
    assert len(episode(env, slalom.Mppi(problem, horizon=5), seed=4).inputs) == 5


CART = """<mujoco><option timestep="0.01"/><worldbody><body name="cart"><joint name="slide" type="slide" axis="1 0 0"/>
<geom size="0.1" mass="2"/></body></worldbody><actuator><motor joint="slide" ctrlrange="-3 3" ctrllimited="true"/></actuator>
<sensor><jointpos joint="slide"/></sensor></mujoco>"""


def test_a_model_of_mujoco_is_a_problem(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    from slalom.mujoco import Problem

    def near(x, u, sensors):
        assert x.shape == (len(u), 2) and np.array_equal(sensors[:, 0], x[:, 0])
        return (x[:, 0] - 1) ** 2 + 0.1 * x[:, 1] ** 2

    (tmp_path / "cart.xml").write_text(CART)
    problems = [Problem(model, near, lambda x: 10 * (x[:, 0] - 1) ** 2, physics_steps=5, threads=threads)
                for model, threads in ((CART, 1), (tmp_path / "cart.xml", 3), (mujoco.MjModel.from_xml_string(CART), 2))]
    assert problems[0].time_step == pytest.approx(0.05) and problems[0].bounds[1] == [3]
    assert problems[0].step([0, 0], [2]) == pytest.approx([0.0015, 0.05])
    drives = [slalom.run(each, slalom.SvgMppi(each, horizon=15, samples=64), each.start, 60) for each in problems]
    assert abs(drives[0].states[-1, 0] - 1) < 0.05 and all(np.array_equal(drives[0].states, each.states) for each in drives)
