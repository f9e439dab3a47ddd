import inspect
import re
import threading
import warnings

import numpy as np
import pytest
import slalom

CLASSES = [slalom.Mppi, slalom.SvgMppi, slalom.ReverseMppi, slalom.SvMpc, slalom.Cem, slalom.Icem, slalom.DialMpc]


def dynamics(x, u):
    return np.stack([x[:, 0] + np.float32(0.1) * x[:, 1], x[:, 1] + np.float32(0.1) * u[:, 0]]).T


def cost(x, u):
    return x[:, 0] ** 2 + np.float32(0.1) * x[:, 1] ** 2 + np.float32(0.1) * u[:, 0] ** 2


def linear(**changes):
    return slalom.Problem(**{"dynamics": dynamics, "cost": cost, "states": 2, "inputs": 1, "dt": 0.1, **changes})


def test_every_option_is_a_keyword_with_its_default():
    for method, cls in zip(slalom.methods(), CLASSES):
        controller = cls(slalom.Pendulum())
        assert controller.method == method
        for option in slalom.options(method):
            assert controller.options[option["name"]] == option["default"]
            again = cls(slalom.Pendulum(), **{option["name"]: option["default"]})
            assert again.options == controller.options and option["name"] in cls.__doc__


@pytest.mark.parametrize("make, error, text", [
    (lambda: slalom.Mppi(slalom.Pendulum(), samples=0), ValueError, r"mppi.samples: '0' must be in \[1, "),
    (lambda: slalom.Mppi(slalom.Pendulum(), sample=10), TypeError, "unknown option 'sample'; did you mean 'samples'"),
    (lambda: slalom.Mppi(slalom.Pendulum(), horizon=2.0), ValueError, "mppi.horizon: '2.0' must be an integer"),
    (lambda: slalom.Mppi(linear()).solve([[0, 0]]), ValueError, r"state: has the shape \(1, 2\), must be \(2,\)"),
    (lambda: linear(input_min=[1, 2, 3]), ValueError, "input_min: has 3 values, must have 1$"),
    (lambda: linear().predict([0, 0], [0, 0]), ValueError, r"inputs: have the shape \(2,\), must have \(steps, 1\)"),
    (lambda: slalom.Mppi(slalom.Pendulum(), samples=1.5), ValueError, "mppi.samples: '1.5' must be an integer"),
    (lambda: slalom.Pendulum(dt=-1), ValueError, "Pendulum.dt"),
    (lambda: slalom.Mppi(slalom.Pendulum()).solve([0, 0, 0]), ValueError, "state: has 3 values, must have 2"),
    (lambda: linear(dynamics=3), ValueError, "dynamics: must be callable"),
    (lambda: linear(states=0), ValueError, "states: 0 must be in"),
    (lambda: slalom.Mppi(linear(dt=0)).solve([0, 0], elapsed=0.1), ValueError, "elapsed: the problem has no dt"),
    (lambda: slalom.Mppi(linear()).solve([0, 0], elapsed=-0.1), ValueError, "elapsed: -0.1.* must be finite and at least 0"),
    (lambda: slalom.Mppi(linear()).solve([0, 0], elapsed=np.nan), ValueError, "elapsed: nan must be finite"),
    (lambda: slalom.Mppi(linear()).solve([0, 0], deadline=np.nan), ValueError, "deadline: nan must be at least 0"),
    (lambda: slalom.Mppi(linear()).solve([0, 0], deadline=-1), ValueError, "deadline: -1.* must be at least 0"),
    (lambda: setattr(slalom.Mppi(linear()), "temperature", 1e-3), AttributeError,
     r"Mppi.temperature cannot be set; make another controller with .*'temperature': 0.001}"),
    (lambda: setattr(slalom.Mppi(linear()), "temprature", 1e-3), AttributeError, "no attribute 'temprature'"),
    (lambda: slalom.Mppi(linear()).options.update(temperature=1), TypeError, "make another one with"),
    (lambda: slalom.Mppi(linear()).options.__setitem__("temperature", 1), TypeError, "cannot be changed"),
    *((lambda method=method, wrong=wrong: method(linear(), horizon=10).solve([0, 0], proposals=wrong), ValueError, text)
      for method, wrong, text in (
          (slalom.Mppi, np.zeros((9, 1)), r"proposals: have the shape \(9, 1\), must have \(sequences, 10, 1\) or "),
          (slalom.Mppi, np.zeros(10), r"have the shape \(10,\), must have"), (slalom.Mppi, np.zeros((3, 0, 1)), r"shape \(3, 0, 1\), must"),
          (slalom.Mppi, np.full((10, 1), np.nan), "proposals: must be finite"),
          (slalom.SvMpc, np.zeros((10, 1)), "proposals: the method sv_mpc does not accept proposals"))),
    *((lambda theirs=theirs: slalom.Mppi(linear(), **{theirs: 1}), TypeError, f"'{theirs}'; did you mean '{ours}'")
      for theirs, ours in {"num_samples": "samples", "K": "samples", "T": "horizon", "lambda_": "temperature",
                           "noise_sigma": "variance", "u_min": "input_min", "u_max": "input_max"}.items()),])
def test_mistakes_name_the_option_the_value_and_the_rule(make, error, text):
    with pytest.raises(error, match=text):
        make()


def test_results_are_views_of_the_controller():
    controller = slalom.SvgMppi(slalom.Pendulum(), horizon=8, samples=100, batches=1, guides=3, guide_iterations=2,
                                 input_min=-5, input_max=5)
    plan = controller.solve([1.0, 0.0])
    shapes = {"nominal": (8, 1), "variances": (8, 1), "samples": (100, 8, 1), "costs": (100,),
              "weights": (100,), "samples_collided": (100,), "guides": (3, 8, 1), "guide_path": (6, 8, 1)}
    for name, shape in shapes.items():
        array = getattr(plan, name)
        assert array.shape == shape and array.base is not None and not array.flags.writeable, name
    assert plan.weights.sum() == pytest.approx(1, abs=1e-4) and plan.samples[:, 0, 0].std() > 0
    kept, held = plan.costs, [plan.inputs, plan.states]
    before = [each.copy() for each in held]
    controller.solve([1.0, 0.0])
    with pytest.raises(RuntimeError, match="solved again"):
        plan.inputs
    del controller, plan
    assert np.all(np.isfinite(kept))  # the view keeps the memory
    assert all(map(np.array_equal, held, before))  # copies


def test_the_callable_problem_agrees_with_the_one_of_ours():
    def dynamics(x, u):
        rate = x[:, 1] + np.float32(0.02) * (np.float32(9.81) * np.sin(x[:, 0]) + u[:, 0])
        return np.stack([x[:, 0] + np.float32(0.02) * rate, rate]).T

    def cost(x, u):
        return np.float32(0.02) * (10 * (1 - np.cos(x[:, 0])) + np.float32(0.1) * x[:, 1] ** 2 + np.float32(0.01) * u[:, 0] ** 2)

    def terminal_cost(x):
        return (x[:, 1] ** 2 / 2 + np.float32(9.81) * (np.cos(x[:, 0]) - 1)) ** 2

    mine = slalom.Problem(dynamics, cost, terminal_cost, states=2, inputs=1, dt=0.02)
    plans = [slalom.Mppi(p, horizon=20, samples=300, seed=5).solve([2.0, 0.5]) for p in (mine, slalom.Pendulum())]
    np.testing.assert_allclose(plans[0].costs, plans[1].costs, rtol=1e-4)
    np.testing.assert_allclose(plans[0].inputs, plans[1].inputs, atol=1e-3)
    assert plans[0].cost == pytest.approx(plans[1].cost, rel=1e-3)


def test_callables_get_whole_batches_without_copies():
    seen = []

    def cost(x, u):
        seen.append((x.shape, u.shape, u.flags.owndata, u.flags.writeable, u.dtype, u.strides[0]))
        return np.zeros(len(x), np.float32)

    slalom.Mppi(linear(cost=cost), horizon=4, samples=1000).solve([0, 0])
    assert [each for each in seen if each[0][0] > 1] == [((1000, 2), (1000, 1), False, False, np.float32, 4)] * 4


def test_collisions_of_callables_are_reported():
    plan = slalom.Mppi(linear(cost=lambda x, u: (x[:, 0] ** 2, u[:, 0] > 0)), horizon=3, samples=200).solve([0, 0])
    assert 0.7 < plan.collided_share < 0.95
    plan = slalom.Mppi(linear(cost=lambda x, u: (x[:, 0], x[:, 0] < 1)), horizon=3).solve([0, 0])
    assert plan.status == "all_collided" and plan.collided


@pytest.mark.parametrize("changes, error, text", [({"cost": lambda x, u: 1 / 0}, ZeroDivisionError, "division"),
    ({"cost": lambda x, u: np.zeros(3)}, ValueError, r"cost: returned shape \(3,\), must be \(1920,\)"),
    ({"cost": lambda x, u: 0.0}, TypeError, "cost: returned <class 'float'>, must be an array"),
    ({"dynamics": lambda x, u: x[:, :1]}, ValueError, r"dynamics: returned shape \(64, 1\), must be \(64, 2\)"),])
@pytest.mark.parametrize("threads", [1, 3])
def test_what_a_callable_throws_is_thrown_by_solve(changes, error, text, threads):
    controller = slalom.Mppi(linear(**changes), samples=64, threads=threads)
    for _ in range(2):
        with pytest.raises(error, match=text):
            controller.solve([0, 0])


def test_solving_lets_other_threads_run():
    controller = slalom.Mppi(slalom.Pendulum(), horizon=200, samples=200000)
    ticks, done = [], threading.Event()

    def count():
        while not done.is_set():
            ticks.append(1)
            done.wait(0.0002)

    other = threading.Thread(target=count)
    other.start()
    before = len(ticks)
    controller.solve([1.0, 0.0])
    during = len(ticks) - before
    done.set()
    other.join()
    assert during >= 2


def test_parameters_change_between_solves():
    controller = slalom.Mppi(slalom.DifferentialDrive(), input_min=[0, -2], input_max=[1.5, 2])
    controller.problem.goal_x = -3
    assert controller.problem.goal_x == -3 and slalom.DifferentialDrive().goal_x == 8
    controller.problem.discs = [(0, 0, 0.1)] * 3
    assert controller.problem.discs[2] == (0, 0, 0.1)
    with pytest.raises(ValueError):
        controller.problem.dt = 0


def test_reset_repeats_and_a_non_finite_state_is_reported():
    controller = slalom.SvgMppi(slalom.Pendulum(), input_min=-5, input_max=5)
    first = controller.solve([1.0, 0.0]).inputs.copy()
    controller.reset(0)
    assert np.array_equal(controller.solve([1.0, 0.0]).inputs, first)
    seeded = slalom.Mppi(slalom.Pendulum(), seed=7)
    other = seeded.solve([1.0, 0.0]).inputs
    seeded.reset()
    assert np.array_equal(seeded.solve([1.0, 0.0]).inputs, other)
    plan = controller.solve([np.nan, 0.0])
    assert plan.status == "non_finite_state" and np.array_equal(plan.inputs, first)


def pushed(**changes):
    """A point moved along a line by two motors, with its cost in terms."""
    def dynamics(x, u):
        return np.stack([x[:, 0] + np.float32(0.1) * x[:, 1], x[:, 1] + np.float32(0.1) * (u[:, 0] + u[:, 1])]).T

    def cost(x, u):
        return {"distance": x[:, 0] ** 2, "effort": np.float32(0.1) * np.sum(u**2, axis=1)}, np.abs(x[:, 0]) > 60

    return slalom.Problem(dynamics, cost, lambda x: 10 * x[:, 0] ** 2, states=2, inputs=2, dt=0.1, **changes)


def test_the_cost_of_a_plan_is_told_by_name():
    plan = slalom.Mppi(pushed(), horizon=5, samples=64).solve([2, 0])
    assert list(plan.cost_terms) == ["distance", "effort", "terminal"]
    assert sum(plan.cost_terms.values()) == pytest.approx(plan.cost)
    assert plan.cost_terms["distance"] == pytest.approx(np.sum(plan.states[:-1, 0] ** 2), rel=1e-5)
    assert not plan.collided and plan.minimum_cost > 0
    assert list(slalom.Mppi(slalom.Pendulum(), horizon=5).solve([1, 0]).cost_terms) == ["stage", "terminal"]


@pytest.mark.parametrize("method", CLASSES)
def test_bounds_of_a_problem_hold_besides_those_of_the_options(method):
    controller = method(pushed(input_min=-0.5, input_max=[0.25, 2]), horizon=6, samples=128, variance=4, input_max=[3, 1])
    assert controller.options["input_min"] == -0.5 and controller.options["input_max"] == [0.25, 1]
    seen = np.concatenate([controller.solve([x, 0]).inputs.copy() for x in (-50, 50, -50, 50)])
    assert seen.min() >= -0.5 and np.all(seen.max(axis=0) <= [0.25, 1])


def test_rates_of_a_problem_hold_from_solve_to_solve():
    controller = slalom.Mppi(pushed(input_rate_max=[2, 0.5]), horizon=6, samples=256, variance=4)
    x, before, reach = np.array([-50.0, 0]), np.zeros(2), np.array([0.2, 0.05]) + 1e-9
    for _ in range(10):
        inputs = controller.solve(x, elapsed=0.1).inputs.copy()
        assert np.all(np.abs(np.diff(np.vstack([before, inputs]), axis=0)) <= reach)
        before, x = inputs[0], controller.problem.step(x, inputs[0])
    assert before[0] > 0.5
    controller.set_previous_input([-2, 0])
    assert np.all(np.abs(controller.solve(x).inputs[0] - [-2, 0]) <= reach)
    with pytest.raises(ValueError, match="Problem.dt: must be positive, since input_rate_max is set"):
        slalom.Problem(lambda x, u: x, lambda x, u: x[:, 0], states=1, inputs=1, input_rate_max=1)
    with pytest.raises(ValueError, match="input_min: has 3 values, must have 1 or 2"):
        pushed(input_min=[1, 2, 3])


def test_a_sampler_brings_its_own_noise():
    def held(random, samples, horizon, inputs):
        return np.repeat(random.standard_normal((samples, 1, inputs)), horizon, axis=1)

    plans = []
    for threads in 1, 3:
        plan = slalom.Mppi(pushed(sampler=held), horizon=6, samples=1000, threads=threads).solve([2, 0])
        assert np.allclose(plan.samples, plan.samples[:, :1]) and np.std(plan.samples[:, 0]) > 0.5
        plans.append(plan.inputs.copy())
    assert np.array_equal(*plans)
    with pytest.raises(ValueError, match=r"sampler: returned shape \(2,\), must be \("):
        slalom.Mppi(pushed(sampler=lambda *_: np.zeros(2)), horizon=6).solve([2, 0])


def public():
    """[(name, function, class or property)] of the package and the modules that need nothing else."""
    import slalom.mlp
    import slalom.ros

    for module in slalom, slalom.mlp, slalom.plot, slalom.ros:
        names = slalom.__all__ if module is slalom else [n for n, v in vars(module).items() if getattr(v, "__module__", "") == module.__name__]
        for name in [each for each in names if not each.startswith("_")]:
            value = getattr(module, name)
            if not (isinstance(value, type) and issubclass(value, (Exception, tuple, dict))):
                yield name, value
                yield from ((f"{name}.{member}", getattr(what, "__func__", what)) for member, what in vars(value).items()
                            if isinstance(value, type) and not member.startswith("_") and (callable(getattr(value, member)) or isinstance(what, property)))


def test_everything_public_says_what_it_is_and_what_it_takes_and_returns():
    missing = []
    for name, value in public():
        words = re.sub(r"^\w+\(.*\) -> .*", "", value.__doc__ or "").strip()
        told, parameters = ", ".join(re.findall(r"^([\w, ]+) : \S", words, re.M)).split(", "), []
        if callable(value) and name not in ("AnyProblem", "Plan", "RandomStream"):  # not constructed by users
            parameters = inspect.signature(value).parameters
        missing += [f"{name}: {each}" for each in parameters if each not in ("self", "cls", "kwargs", "drawing", *told)]
        missing += [name] * (not words or inspect.isfunction(value) and "Returns\n---" not in words)
    assert not missing


def test_a_symptom_that_stays_is_reported_once():
    cold = slalom.Mppi(linear(), horizon=10, samples=64, temperature=1e-6)
    with pytest.warns(slalom.SymptomWarning, match="few_samples in 20 solves in a row: .* single samples") as caught:
        for solve in range(1, 31):
            assert cold.solve([1.0, 0.0]).symptom == ("few_samples" if solve >= 20 else "none")
    assert len(caught) == 1 and caught[0].filename == __file__

    warm = slalom.Mppi(linear(), horizon=10, samples=64)
    with warnings.catch_warnings():
        warnings.simplefilter("error", slalom.SymptomWarning)
        for k in range(30):
            assert warm.solve([1.0 - k / 10, 0.0]).symptom == "none"


def test_proposals_compete_with_the_samples():
    problem = linear(cost=lambda x, u: np.float32(100) * (u[:, 0] - 3) ** 2)
    options = {"horizon": 10, "variance": 0.01, "control_cost_discount": 1}
    right = np.full((10, 1), 3.0)
    assert np.all(np.abs(slalom.Mppi(problem, **options).solve([0, 0]).inputs) < 1)
    for proposals in (right, [right, 0 * right]):
        plan = slalom.Mppi(problem, **options).solve([0, 0], proposals=proposals)
        assert plan.inputs == pytest.approx(right)
    assert np.all(plan.samples[-2] == 3) and plan.weights[-2] == pytest.approx(1)
    assert np.all(np.abs(slalom.Mppi(problem, **options).solve([0, 0], proposals=[]).inputs) < 1)


@pytest.mark.parametrize("method", [slalom.Mppi, slalom.SvgMppi, slalom.Icem])
def test_a_plan_costs_at_most_as_much_as_a_proposal(method):
    options, x = {"horizon": 150, "input_min": -10, "input_max": 10}, [0, 0, 0.2, 0]
    holding = slalom.run(slalom.CartPole(), slalom.SvgMppi(slalom.CartPole(), **{**options, "horizon": 40}), x, 150).inputs
    plain, plan = method(slalom.CartPole(), **options).solve(x), method(slalom.CartPole(), **options).solve(x, proposals=holding)
    assert plan.cost <= slalom.CartPole().predict(x, holding)[1] + 1e-3 < 0.1 * plain.cost


def test_signatures_name_options_and_arguments():
    options = inspect.signature(slalom.SvgMppi).parameters
    assert list(options)[0] == "problem" and options["guides"].default == 2
    assert inspect.signature(slalom.Pendulum).parameters["dt"].default == slalom.Pendulum().dt
    assert inspect.signature(slalom.Problem).parameters["sampler"].default is None
    solve = inspect.signature(slalom.Mppi(linear()).solve).parameters
    assert list(solve) == ["state", "elapsed", "deadline", "proposals"] and solve["deadline"].default == np.inf


def test_a_class_derived_from_a_controller_may_have_attributes():
    class Mine(slalom.Mppi):
        pass

    mine = Mine(linear())
    mine.note = 3
    assert mine.note == 3
    with pytest.raises(AttributeError, match="temperature cannot be set"):
        mine.temperature = 1
