"""Figures 1, 3 and 4 of Honda et al. (ICRA 2024), computed for a point that passes a disc: `slalom explain`. Needs matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _slalom, study

STEPS, DT, DISC, RADIUS = 20, 0.2, 2.0, 0.5  # horizon; s; place and radius of the disc, m; the point moves at 1 m/s
BESIDE = round(DISC / DT)  # the state beside the disc
PLACES = np.linspace(-1.99, 1.99, 200)  # m


def _place_cost(x: Any) -> tuple[Any, Any]:
    inside = (x[..., 0] - DISC) ** 2 + x[..., 1] ** 2 < RADIUS**2
    return 0.5 * x[..., 1] ** 2 + 10 * inside, inside


def _step(x: Any, u: Any) -> Any:
    return np.stack([x[:, 0] + np.float32(DT), x[:, 1] + np.float32(DT) * u[:, 0]]).T


def _cost(x: Any, u: Any) -> tuple[Any, Any]:
    cost, inside = _place_cost(x)
    return cost + 0.05 * u[:, 0] ** 2, inside


def ways(inputs: Any) -> Any:
    """The lateral positions (m) at all states of sequences [n, steps]."""
    return np.pad(DT * np.cumsum(inputs, axis=-1), [(0, 0)] * (np.ndim(inputs) - 1) + [(1, 0)])


def costs(inputs: Any) -> Any:
    """The costs of sequences [n, steps]."""
    y = ways(inputs)
    return _place_cost(np.stack([np.broadcast_to(DT * np.arange(STEPS + 1), y.shape), y], -1))[0].sum(-1) + 0.05 * (inputs**2).sum(-1)


def optimal_density() -> Any:
    """q*(v) ~ exp(-S(v)) N(v | 0, 1) of the place beside the disc, at PLACES: a histogram, a little smoothed."""
    inputs = np.random.default_rng(0).standard_normal((1 << 18, STEPS), np.float32)
    counts = np.histogram(ways(inputs)[:, BESIDE], 200, (-2, 2), weights=np.exp(-costs(inputs)))[0]
    smooth = np.convolve(counts, np.exp(-np.arange(-5, 6) ** 2 / 4.5), "same")
    return smooth / (smooth.sum() * (PLACES[1] - PLACES[0]))


def gaussian(x: Any, mean: Any, deviation: Any) -> Any:
    return np.exp(-0.5 * ((x - mean) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))


def solved(method: str, seed: int, **options: Any) -> Any:
    problem = _slalom.Problem(_step, _cost, lambda x: _place_cost(x), states=2, inputs=1, dt=DT)
    return _slalom.Controller(method, problem, horizon=STEPS, temperature=1.0, variance=1.0, input_min=-3, input_max=3, seed=seed,
                              **options).solve([0.0, 0.0])


def draw_space(axis: Any, beside: Any, plan: Any, optimum: Any) -> None:
    """Samples, guides, plan and distribution from above, and the densities of the place beside the disc."""
    ahead = DT * np.arange(STEPS + 1)
    samples, hits = ways(plan.samples[:, :, 0]), plan.samples_collided > 0
    best = np.argsort(plan.costs)[::-1]
    low = plan.costs[~hits].min() if (~hits).any() else 0
    for k in best[-100:] if len(best) > 100 else best:
        cost = min(1, (plan.costs[k] - low) / 4)
        axis.plot(ahead, samples[k], color="tab:red" if hits[k] else (0.85 * cost, 0.3 + 0.4 * cost, 0.6 - 0.2 * cost), linewidth=0.8,
                  alpha=0.12 if hits[k] else 0.25 + 0.6 * plan.weights[k] / plan.weights.max())
    mean, deviation = ways(plan.mean[:, 0]), np.sqrt(np.append(0, np.cumsum(DT**2 * plan.variances[:, 0])))
    axis.fill_between(ahead, mean - 2 * deviation, mean + 2 * deviation, color="tab:blue", alpha=0.2, label="distribution, 2 deviations")
    for number, path in enumerate(ways(plan.guide_path[:, :, 0])):
        age = (number // len(plan.guides) + 1) * len(plan.guides) / len(plan.guide_path)
        axis.plot(ahead, path, color="tab:purple", alpha=0.1 + 0.8 * age**2, linewidth=1, label="guides" if number + 1 == len(plan.guide_path) else None)
    axis.add_patch(study.needed("matplotlib.patches").Circle((DISC, 0), RADIUS, color="dimgray"))
    place = plan.states[BESIDE, 1]
    axis.plot(ahead, plan.states[:, 1], color="black", linewidth=3, label="plan")
    axis.set(xlabel="ahead, m", ylabel="to the left, m", ylim=(-1.5, 1.5), title=f"{plan.controller.method}: the plan " + (
        "hits the disc" if plan.collided else f"passes on the {'left' if place > 0 else 'right'}, {abs(place):.2f} m"))
    axis.legend(fontsize="small", loc="lower left")
    highest = 3 * optimum.max()  # both densities share a scale, cut where one is a needle
    beside.fill_betweenx(PLACES, optimum, color="tab:orange", alpha=0.4, label="optimal, q*")
    beside.plot(np.minimum(gaussian(PLACES, mean[BESIDE], max(1e-3, deviation[BESIDE])), highest), PLACES, color="tab:blue")
    beside.axhline(place, color="black", linewidth=2)
    beside.set(xlabel="density beside the disc", ylim=(-1.5, 1.5))
    beside.legend(fontsize="small")


def draw_asymmetry(axis: Any, optimum: Any) -> None:
    """The Gaussians of least forward and of least reverse divergence."""
    weights = optimum / optimum.sum()
    mean = weights @ PLACES
    means, deviations = np.meshgrid(np.arange(-1, 1.005, 0.01), np.arange(0.02, 1.005, 0.01))
    q = gaussian(PLACES[:, None, None], means, deviations)
    divergence = np.where(q > 1e-12, q * np.log(np.maximum(q, 1e-12) / np.maximum(optimum, 1e-9)[:, None, None]), 0).sum(0)
    least = divergence.argmin()
    axis.plot(PLACES, optimum, color="tab:orange", label="optimal distribution q*")
    axis.plot(PLACES, gaussian(PLACES, mean, np.sqrt(weights @ PLACES**2 - mean**2)), color="tab:red", label="least KL(q* || q), forward")
    axis.plot(PLACES, gaussian(PLACES, means.flat[least], deviations.flat[least]), color="tab:green", label="least KL(q || q*), reverse")
    axis.set(xlabel="place beside the disc, m", ylabel="density")
    axis.legend()


def draw_fit(axis: Any, plan: Any) -> None:
    """The input of the best guide that moved most, after each of its steps, with q* there and the Gaussian that (13) fits."""
    paths = plan.guide_path[:, :, 0].astype(float).reshape(-1, len(plan.guides), STEPS)
    path, variances = paths[:, costs(paths[-1]).argmin()], plan.variances[:, 0]
    step = np.where(variances > 0.99, -1, np.abs(path[-1] - path[0])).argmax()  # the largest variance, 1: undetermined
    a, log_b = path[:, step], -costs(path) - 0.5 * ((path - path[-1]) ** 2).sum(1)
    b, z2 = np.exp(log_b - log_b.max()), -0.5 / variances[step]
    z1, z0 = np.polyfit(a, np.log(b) - z2 * a**2, 1, w=b)  # with the solver's variance, the rest of the parabola is a line
    inputs = np.linspace(-2.5, 2.5, 201)
    axis.plot(a, b, "o", color="tab:purple", label="q* along the best guide's path")
    axis.plot(inputs, np.exp(z0 + z1 * inputs + z2 * inputs**2), color="tab:green", label="the fitted Gaussian")
    axis.set(xlabel=f"input {step} of the horizon, m/s", ylabel="density", title="(c) The covariance of one input, equation 13")
    axis.legend()


def draw(number: int, seed: int) -> Any:
    """A matplotlib figure: 1, 3 or 4 of the paper."""
    optimum, make = optimal_density(), study.needed("matplotlib.figure").Figure
    if number == 3:
        figure = make(figsize=(6, 4), layout="constrained")
        draw_asymmetry(figure.add_subplot(), optimum)
        figure.suptitle("Fig. 3: forward KL covers both modes, reverse KL seeks one")
        return figure
    figure = make(figsize=(14 if number == 4 else 8, 4.5), layout="constrained")
    space, beside, *rest = figure.subplots(1, 3 if number == 4 else 2, width_ratios=(3, 1, 2)[:3 if number == 4 else 2])
    if number == 1:
        draw_space(space, beside, solved("mppi", seed, control_cost_discount=0), optimum)
        figure.suptitle("Fig. 1: the mean of both ways hits the disc")
        return figure
    plan = solved("svg_mppi", seed, batches=1, guides=4, guide_iterations=10, guide_step=0.125, guide_variance=1, restart_variance=1,
                  variance_max=1, gradient_samples=25, gradient_variance=0.25, gradient_temperature=1, restart_guides=False,
                  variance_min=0.01, noise_exponent=0)
    draw_space(space, beside, plan, optimum)
    draw_fit(rest[0], plan)
    figure.suptitle("Fig. 4: (a) guides, (b) the best of them, (d) MPPI near it")
    return figure


def main() -> None:
    """Does `slalom explain`, whose words are those of this process."""
    words = study.words_of_process()
    given = dict(zip(words[::2], words[1::2]))
    file, kind = given["--plot"], given["--plot"].rpartition(".")[2].lower()
    draw(int(given["--figure"]), int(given.get("--seed", 0))).savefig(file, format=kind if kind in ("svg", "pdf") else "png", dpi=150)
