import copy
import pickle

import numpy as np
import pytest
import slalom


def pushed(wind=0.0):
    """A point on a line that a wind moves, m/s."""
    def dynamics(x, u):
        return x + np.float32(0.1) * (u + np.float32(wind))

    return slalom.Problem(dynamics, lambda x, u: np.abs(x[:, 0]), states=1, inputs=1, dt=0.1, input_min=-2, input_max=2)


def windy(random):
    return pushed(random.normal())


def cart(random):
    return slalom.CartPole(track=random.uniform(2, 3))


def test_variants_come_in_mirrored_pairs_and_are_those_of_cpp():
    drawn = []

    def randomize(random):
        drawn.append((random.normal(), random.uniform(), random.uniform(2, 4)))
        return pushed()

    slalom.RiskEvaluator(pushed(), randomize, variants=5, seed=3)
    assert len(drawn) == 4
    for (z, u, v), (mirrored_z, mirrored_u, mirrored_v) in zip(drawn[::2], drawn[1::2]):
        assert mirrored_z == -z and mirrored_u == pytest.approx(1 - u, abs=1e-6)
        assert mirrored_v == pytest.approx(6 - v, abs=1e-5)
    assert drawn[0] != drawn[2]


@pytest.mark.parametrize("measure, expected", [("mean", lambda c: c.mean(0)), ("worst", lambda c: c.max(0)),
                                               ("cvar", lambda c: np.sort(c, 0)[-2:].mean(0))])
def test_the_cost_of_a_sample_is_the_measure_of_its_costs_in_all_variants(measure, expected):
    risk = slalom.RiskEvaluator(pushed(), windy, variants=5, measure=measure, tail=0.4)
    common = dict(horizon=6, samples=300, seed=7)
    plan = slalom.Mppi(risk, **common).solve([1.0])
    each = np.stack([slalom.Mppi(risk.variant(m), **common).solve([1.0]).costs for m in range(5)])
    assert each.std(axis=0).min() > 0
    np.testing.assert_allclose(plan.costs, expected(each), rtol=1e-5)
    assert plan.cost == pytest.approx(expected(np.array([cost_of(risk.variant(m), plan.inputs) for m in range(5)])), rel=1e-4)
    assert list(plan.cost_terms) == ["total"]


def cost_of(problem, inputs):
    x, cost = np.array([1.0]), 0.0
    for u in inputs:
        cost += abs(x[0])
        x = problem.step(x, u)
    return cost


def test_built_in_problems_have_variants_too():
    risk = slalom.RiskEvaluator(slalom.CartPole(), cart, variants=3, measure="worst")
    assert risk.variant(1).track != slalom.CartPole().track and risk.problem.track == slalom.CartPole().track
    plans = [slalom.SvgMppi(risk, horizon=10, samples=200, threads=n, seed=2).solve([2, 0, 0.1, 0]).inputs.copy() for n in (1, 3)]
    assert np.array_equal(*plans)


def test_a_sample_collides_if_it_collides_in_any_variant():
    risk = slalom.RiskEvaluator(slalom.CartPole(track=100), lambda random: slalom.CartPole(track=0.1), variants=2)
    assert slalom.Mppi(risk, horizon=5, samples=64).solve([1, 0, 0, 0]).collided_share == 1
    assert slalom.Mppi(risk.problem, horizon=5, samples=64).solve([1, 0, 0, 0]).collided_share == 0


def test_it_prints_and_is_pickled():
    risk = slalom.RiskEvaluator(slalom.CartPole(), cart, variants=3, measure="cvar")
    assert repr(risk) == ("slalom.RiskEvaluator(slalom.CartPole(), cart, variants=3, measure='cvar', tail=0.25, "
                          "aversion=0.1, seed=0)")
    for same in pickle.loads(pickle.dumps(risk)), copy.deepcopy(risk):
        assert repr(same) == repr(risk) and same.variant(2).track == risk.variant(2).track


@pytest.mark.parametrize("arguments, error, text", [(dict(randomize=3), ValueError, "randomize: must be callable"),
    (dict(randomize=lambda random: 1), TypeError, "randomize: returned <class 'int'>, must be a problem"),
    (dict(randomize=cart), ValueError, "4 states and 1 inputs, must have 1 and 1"),
    (dict(variants=0), ValueError, "risk_variants: 0 must be in"),
    (dict(measure="luck"), ValueError, "RiskEvaluator.risk_measure: 'luck'"),])
def test_mistakes_are_named(arguments, error, text):
    with pytest.raises(error, match=text):
        slalom.RiskEvaluator(pushed(), **{"randomize": windy, **arguments})


def test_what_a_callable_of_a_variant_throws_is_thrown_by_solve():
    broken = slalom.Problem(lambda x, u: x, lambda x, u: 1 / 0, states=1, inputs=1)
    controller = slalom.Mppi(slalom.RiskEvaluator(pushed(), lambda random: broken, variants=2), horizon=3)
    with pytest.raises(ZeroDivisionError):
        controller.solve([0])
