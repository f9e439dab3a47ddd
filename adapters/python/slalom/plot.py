"""Figures of a plan, to see why a controller does what it does (docs/my-robot-does-not.md), and of a lap. Needs
matplotlib."""

from __future__ import annotations

import importlib
import io
from typing import Any, Callable, Dict, Sequence

import numpy as np

_MOST_LINES = 60  # samples that are drawn


def plan(plan: Any, state_names: Sequence[str] = (), input_names: Sequence[str] = ()) -> Any:
    """A matplotlib figure of a plan: samples, guides and inputs within their bounds, predicted states, costs and weights
    of the samples, and the cost by term. `figure.savefig("plan.png")` writes it to a file. Names are such as "speed, m/s"."""
    Figure = importlib.import_module("matplotlib.figure").Figure
    inputs = plan.inputs.shape[1]
    figure = Figure(figsize=(11, 2.2 * (inputs + 2)), layout="constrained")
    rows = figure.subfigures(2, 1, height_ratios=(inputs, 2))
    axes = rows[0].subplots(inputs, 1, sharex=True, squeeze=False)[:, 0]
    for index, axis in enumerate(axes):
        _inputs(axis, plan, index)
        axis.set_ylabel(input_names[index] if input_names else f"input {index}")
    axes[-1].set_xlabel("step")
    axes[0].legend(loc="upper right", fontsize="small")
    states, costs, weights, terms = rows[1].subplots(2, 2).flat
    _states(states, plan, state_names)
    _costs(costs, plan)
    _weights(weights, plan)
    _terms(terms, plan)
    figure.suptitle(f"{plan.controller.method}: {plan.status}, cost {plan.cost:.4g}")
    return figure


class Lap(Dict[str, Any]):
    """The results of a lap by name. A notebook shows them as a picture."""

    def __init__(self, results: Dict[str, Any], waypoints: Any) -> None:
        super().__init__(results)
        self.waypoints = waypoints  # [n, 4]: x, y, yaw, speed of the course

    def _repr_png_(self) -> bytes | None:
        return _png(lap, self)


def lap(lap: Lap) -> Any:
    """A matplotlib figure of a lap from above: the path of the car coloured by its speed, the line of the course, and the
    parked cars."""
    Figure = importlib.import_module("matplotlib.figure").Figure
    figure = Figure(figsize=(8, 6), layout="constrained")
    axis = figure.add_subplot()
    axis.plot(lap.waypoints[:, 0], lap.waypoints[:, 1], color="tab:gray", linestyle="--", linewidth=0.8, label="course")
    for number, (x, y, _) in enumerate(lap["obstacles"]):
        axis.plot(x, y, "s", color="tab:orange", label="parked car" if number == 0 else None)
    driven = axis.scatter(*lap["path"][:, :2].T, c=lap["path"][:, 3], s=4, label="driven")
    figure.colorbar(driven, label="speed, m/s")
    axis.set_aspect("equal")
    axis.set_xlabel("x, m")
    axis.set_ylabel("y, m")
    axis.legend(fontsize="small")
    end = "finished" if lap["finished"] else "not finished"
    axis.set_title(f"{end}, {lap['time']:.2f} s, {lap['collisions']} collision{'' if lap['collisions'] == 1 else 's'}")
    return figure


def _png(draw: Callable[[Any], Any], what: Any) -> bytes | None:
    """The figure that `draw` makes, as a notebook shows it; None, so that it shows the text, if there is no matplotlib or
    the plan is of an earlier solve."""
    try:
        figure = draw(what)
    except (ImportError, RuntimeError):
        return None
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=80)
    return image.getvalue()


def saturation(plan: Any) -> Any:
    """The share of the steps, 0 ... 1, in which each input of a plan is at one of its bounds: an array [inputs]."""
    low, high = _bounds(plan)
    result = np.mean((plan.inputs <= low) | (plan.inputs >= high), axis=0)
    return np.where(low < high, result, 0.0)


def _bounds(plan: Any) -> tuple[Any, Any]:
    options, inputs = plan.controller.options, plan.inputs.shape[1]
    return np.broadcast_to(options["input_min"], inputs), np.broadcast_to(options["input_max"], inputs)


def _lines(axis: Any, rows: Any, label: str, **style: Any) -> None:
    """A line for each row, with one entry in the legend."""
    for number, row in enumerate(rows):
        axis.plot(row, label=label if number == 0 else None, **style)


def _inputs(axis: Any, plan: Any, index: int) -> None:
    samples = plan.samples[:, :, index]
    best = np.argsort(plan.weights)[::-1][:_MOST_LINES // 2]
    others: Any = np.linspace(0, len(samples) - 1, _MOST_LINES // 2).astype(int) if len(samples) else []
    _lines(axis, samples[others], "samples", color="tab:gray", alpha=0.25, linewidth=0.6)
    _lines(axis, samples[best], "samples of largest weight", color="tab:blue", alpha=0.3, linewidth=0.8)
    _lines(axis, plan.guides[:, :, index], "guides", color="tab:orange", linestyle="--")
    _lines(axis, [plan.inputs[:, index]], "plan", color="tab:green", linewidth=2.5)
    for bound in (each[index] for each in _bounds(plan) if np.isfinite(each[index])):
        axis.axhline(bound, color="black", linewidth=0.8)
    axis.set_title(f"at a bound in {100 * saturation(plan)[index]:.0f} % of the steps", loc="left", fontsize="small")


def _states(axis: Any, plan: Any, names: Sequence[str]) -> None:
    for index in range(min(plan.states.shape[1], 10)):
        axis.plot(plan.states[:, index], label=names[index] if names else f"state {index}")
    axis.set_title("predicted states", loc="left", fontsize="small")
    axis.set_xlabel("step")
    axis.legend(fontsize="small")


def _costs(axis: Any, plan: Any) -> None:
    costs = np.sort(plan.costs[np.isfinite(plan.costs)]).astype(float)
    near = costs[costs <= costs[0] + 20 * (costs[len(costs) // 4] - costs[0])] if len(costs) else costs
    axis.set_title(f"costs of {len(plan.costs)} samples: {100 * plan.collided_share:.0f} % collide, "
                   f"{len(plan.costs) - len(costs)} not finite, {len(costs) - len(near)} beyond the right edge",
                   loc="left", fontsize="small")
    if len(near):
        axis.hist(near, bins=50, color="tab:gray")
    axis.axvline(plan.cost, color="tab:green", linewidth=2.5, label="plan")
    axis.legend(fontsize="small")


def _weights(axis: Any, plan: Any) -> None:
    axis.plot(np.arange(1, len(plan.weights) + 1), np.cumsum(np.sort(plan.weights)[::-1]))
    axis.set_xscale("log")
    axis.set_title(f"sum of the largest weights: effective sample size {plan.effective_sample_size:.1f} at temperature "
                   f"{plan.temperature:.3g}", loc="left", fontsize="small")
    axis.set_xlabel("samples")


def _terms(axis: Any, plan: Any) -> None:
    terms = plan.cost_terms
    axis.barh(list(terms), list(terms.values()), color="tab:green")
    axis.set_title("cost of the plan by term", loc="left", fontsize="small")
