"""Mistakes of users that would otherwise be silent, objects that are freed, and those that were never constructed."""

import gc
import warnings
import weakref

import numpy as np
import pytest
import slalom
from slalom.mlp import Mlp
from test_controllers import cost, dynamics, linear


@pytest.mark.parametrize("part, argument", [("dynamics", 0), ("dynamics", 1), ("cost", 0), ("cost", 1), ("terminal_cost", 0)])
def test_callables_cannot_write_what_they_are_lent(part, argument):
    def writes(*arguments):
        arguments[argument][:] = 0
        return dynamics(*arguments)

    for samples in 64, 1000:
        with pytest.raises(ValueError, match="read-only"):
            slalom.Mppi(linear(**{part: writes}), horizon=4, samples=samples).solve([0, 0])


@pytest.mark.parametrize("call", [slalom.Mppi, slalom.signed_distance, lambda text: setattr(linear(), "dt", text)])
def test_messages_do_not_repeat_long_values(call):
    with pytest.raises(TypeError, match=r"(?s)^(?=.{,1000}$).*incompatible.* \.\.\.$"):
        call("a" * 5000)


def test_dynamics_may_return_their_own_buffer_and_costs_keep_their_states():
    buffer = np.zeros((1000, 2), np.float32)
    problem = linear(dynamics=lambda x, u: np.add(dynamics(x, u), 0, out=buffer) if len(x) == 1000 else dynamics(x, u))
    slalom.Mppi(problem, horizon=4, samples=1000).solve([1, 0])
    assert buffer.flags.writeable and buffer.any()
    kept = []
    controller = slalom.Mppi(linear(cost=lambda x, u: kept.append((x, x.copy())) or cost(x, u)), horizon=4, samples=64)
    for x in [1, 0], [5, 0]:
        controller.solve(x)
    assert len(kept) > 3 and all(np.array_equal(x, before) for x, before in kept)


def spoilt(values):
    """Values of which every second is nan."""
    values[::2] = np.nan
    return values


@pytest.mark.parametrize("method", ["mppi", "svg_mppi", "cem"])
def test_samples_of_nan_are_counted_and_told_once(method):
    problem = linear(dynamics=lambda x, u: spoilt(dynamics(x, u)) if len(x) > 1 else dynamics(x, u))
    controller = slalom.Controller(method, problem, horizon=5, samples=64)
    with pytest.warns(slalom.SymptomWarning, match="cost: nan for .* samples") as caught:
        plans = [controller.solve([1, 0]).corrections for _ in range(3)]
    assert min(plans) >= 8 and sum("nan" in str(each.message) for each in caught) == 1


def test_a_prediction_that_is_not_finite_shows_in_the_status():
    def wrong(x, u):
        return np.full(len(x), np.nan) if len(x) == 1 else cost(x, u)

    plan = slalom.Mppi(linear(cost=wrong), horizon=5, samples=1000).solve([1, 0])
    assert plan.status == "degenerate" and not plan.ok and plan.corrections > 0


def test_an_elapsed_beyond_the_horizon_and_random_costs_are_told():
    with pytest.warns(slalom.SymptomWarning, match="elapsed: 100.0 s is longer than the horizon of 0.5 s"):
        slalom.Mppi(linear(), horizon=5).solve([0, 0], elapsed=100)
    for random in {"cost": lambda x, u: np.random.rand(len(x))}, {"dynamics": lambda x, u: x + np.random.rand(*x.shape)}:
        with pytest.warns(slalom.SymptomWarning, match="other values for the same arguments"):
            slalom.Mppi(linear(**random), horizon=5).solve([0, 0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        slalom.Mppi(linear(), horizon=5).solve([0, 0], elapsed=0.5)


class Agent:
    def __init__(self, keep):
        keep(self)

    def dynamics(self, x, u):
        return dynamics(x, u)

    def cost(self, x, u):
        return cost(x, u)

    def problem(self):
        return linear(dynamics=self.dynamics, cost=self.cost)

    def variant(self, random):
        return slalom.Pendulum()


def keeps_controller(agent):
    agent.controller = slalom.Mppi(agent.problem(), horizon=4)
    agent.plan = agent.controller.solve([0, 0])
    agent.inner = agent.controller.problem


def keeps_network(agent):
    network = Mlp([(np.zeros((2, 3)), np.zeros(2))])
    network.owner = agent
    agent.network = slalom.MlpProblem(network)


def keeps_navigator(agent):
    costmap = slalom.Costmap(slalom.OccupancyGrid(np.zeros((30, 30)), 0.1))
    agent.navigator = slalom.Navigator(slalom.Footprint.rectangle(0.2, 0.2, 0.3), costmap)
    agent.navigator.set_cost(agent.cost)


@pytest.mark.parametrize("keep", [
    keeps_controller, keeps_network, *[keeps_navigator] * bool(slalom._driving), lambda agent: setattr(agent, "mine", agent.problem()),
    lambda agent: setattr(agent, "mine", slalom.RiskEvaluator(slalom.Pendulum(), agent.variant)),
    lambda agent: setattr(agent, "mine", slalom.Mppi(slalom.RiskEvaluator(agent.problem(), lambda _: agent.problem())))])
def test_an_object_whose_methods_are_the_callables_is_freed(keep):
    agents = [weakref.ref(Agent(keep)) for _ in range(5)]
    gc.collect()
    assert not any(agent() for agent in agents)


def test_objects_that_were_never_constructed_raise():
    classes = [each for module in filter(None, (slalom._slalom, slalom._driving)) for each in vars(module).values()
               if isinstance(each, type) and not issubclass(each, Exception)]
    for cls in classes:
        empty = cls.__new__(cls)
        for name in [name for name in dir(cls) if not name.startswith("__")]:
            with pytest.raises((TypeError, AttributeError)):
                member = getattr(empty, name)
                for arguments in (), (0,), ([0],), ([0], [0]):
                    if callable(member):
                        with pytest.raises((TypeError, ValueError)):
                            member(*arguments)
                raise TypeError
        for name in [name for name, member in vars(cls).items() if isinstance(member, property) and member.fset]:
            with pytest.raises((TypeError, ValueError)):
                setattr(empty, name, 1)
    for call in (lambda: slalom.solve_batch([slalom.Mppi.__new__(slalom.Mppi)], [[0, 0]]), lambda: repr(slalom.Field.__new__(slalom.Field))):
        with pytest.raises((TypeError, RuntimeError)):
            call()


def test_a_command_is_the_first_input_of_a_plan_a_step_later():
    commanded, solved = (slalom.Mppi(linear(), horizon=10, seed=3) for _ in range(2))
    x = np.array([1.0, 0.0])
    for k in range(3):
        u = commanded.command(x)
        assert np.array_equal(u, solved.solve(x, elapsed=0.1 if k else 0).inputs[0]) and u.flags.writeable
        x = commanded.problem.step(x, u)


def test_a_sequence_is_predicted():
    inputs = np.linspace(-1, 1, 5)[:, None]
    states, total = linear(cost=lambda x, u: u[:, 0] ** 2).predict([1, 0], inputs)
    assert states.shape == (6, 2) and total == pytest.approx(np.sum(inputs**2))
    assert states[1:, 1] == pytest.approx(0.1 * np.cumsum(inputs))
    pendulum = slalom.Pendulum()
    assert pendulum.predict([1, 0], inputs)[0][1] == pytest.approx(pendulum.step([1, 0], inputs[0]))
    assert pendulum.time_step == pendulum.dt and [*map(len, pendulum.bounds)] == [1, 1]
