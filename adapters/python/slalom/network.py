"""A problem whose dynamics is a network."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _slalom, compiler
from .mlp import Mlp

_SOURCE = """{}#include <slalom/python/network_struct.hpp>
struct Network : slalom::python::NetworkStruct<{}, {}, {}, {}, {}> {{
  static constexpr int inputs = {};
}};
"""


def MlpProblem(network: Mlp, *, goal: ArrayLike = 0, state_weights: ArrayLike = 0, terminal_weights: ArrayLike = 0,
               input_weights: ArrayLike = 0, discs: Sequence[tuple[float, float, float]] = (), disc_weight: float = 0,
               walls: _slalom.Field | None = None, clearance: float = 0, field: _slalom.Field | None = None,
               field_weight: float = 1, dt: float = 0, input_min: ArrayLike = -np.inf, input_max: ArrayLike = np.inf,
               gpu: int | Sequence[int] = ()) -> _slalom.CompiledProblem:
    """A problem whose dynamics is a network, compiled once for each size (slalom.compile). The cost of a state is the sum
    of weight * (state - goal)^2, that of inputs the sum of weight * input^2. All parts are attributes.
    """
    if not isinstance(network, Mlp):
        raise TypeError(f"MlpProblem.network: {network!r} must be a slalom.mlp.Mlp")
    states = len(network.layers[-1][1])
    entering = network.layers[0][0].shape[1]
    inputs = entering - states
    if inputs < 1 or entering > 64:
        raise ValueError(f"MlpProblem.network: maps {entering} values to {states}, must map a state and the inputs of a "
                         "step, at most 64 values, to the next state")
    maps = ["slalom::python::NoField" if each is None else "slalom::maps::Field" for each in (walls, field)]
    header = "#include <slalom/maps/field.hpp>\n" * (walls is not None or field is not None)
    if states < 2 and (len(discs) or header):
        raise ValueError("MlpProblem: discs, walls and field need a state of at least 2 values, x and y first")

    def spread(values: ArrayLike, count: int, name: str) -> Any:
        if np.ndim(values) > 1 or np.size(values) not in (1, count):
            raise ValueError(f"MlpProblem.{name}: has {np.size(values)} values, must have 1 or {count}")
        return np.broadcast_to(np.asarray(values, float), count)

    source = _SOURCE.format(header, states, inputs, len(discs), *maps, inputs)
    parts: dict[str, Any] = {"network": network, "dt": dt, "disc_weight": disc_weight, "clearance": clearance, "field_weight": field_weight,
             **{name: spread(values, states, name) for name, values in (
                 ("goal", goal), ("state_weights", state_weights), ("terminal_weights", terminal_weights))},
             **{name: spread(values, inputs, name) for name, values in (
                 ("input_weights", input_weights), ("input_min", input_min), ("input_max", input_max))},
             "discs": discs, "walls": walls, "field": field}
    return compiler.compile_members(source, "Network", {name: value for name, value in parts.items()
                                                        if value is not None and np.size(value)}, gpu=gpu)
