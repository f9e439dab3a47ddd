"""Callables of a problem on torch tensors, which share the memory of the arrays; networks that torch has trained."""

from __future__ import annotations

import functools
from typing import Any, Callable

import numpy as np
import torch

from . import display
from .mlp import Mlp

_ACTIVATIONS = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu", torch.nn.Softplus: "softplus", torch.nn.SiLU: "silu"}


def to_mlp(network: torch.nn.Sequential, *, residual: bool = False) -> Mlp:
    """The Mlp of a trained network, for instance to save it for slalom::load_mlp in C++."""
    layers: list[tuple[Any, Any]] = []
    activations: list[str] = []
    for i, part in enumerate(network):
        if isinstance(part, torch.nn.Linear) and len(layers) == len(activations):
            weights = part.weight.detach().numpy()
            layers.append((weights, np.zeros(len(weights)) if part.bias is None else part.bias.detach().numpy()))
        elif type(part) in _ACTIVATIONS and len(layers) > len(activations) and getattr(part, "beta", 1) == 1:
            activations.append(_ACTIVATIONS[type(part)])
        elif not isinstance(part, (torch.nn.Identity, torch.nn.Dropout)):
            raise ValueError(f"to_mlp: part {i}: {part} must be Linear, followed by Tanh, ReLU, Softplus with beta=1 or SiLU")
    if len(layers) != len(activations) + 1 or len(set(activations)) > 1:
        raise ValueError(f"to_mlp: {len(layers)} Linear with {activations} must have the same activation after each but "
                         "the last")
    return Mlp(layers, activations[0] if activations else "tanh", residual=residual)


def on_tensors(function: Callable[..., Any]) -> Callable[..., Any]:
    """Decorates dynamics, a cost or a terminal cost that is written for torch tensors:

        @on_tensors
        def dynamics(x, u):           # tensors x [K, states], u [K, inputs] on the CPU
            return torch.stack([x[:, 0] + 0.1 * x[:, 1], x[:, 1] + 0.1 * u[:, 0]]).T

    Its arguments are tensors on the memory of the solver's arrays, which reads the results where they are: nothing is
    copied. A function that changes its arguments raises ValueError. Gradients are not recorded.
    """

    @functools.wraps(function)
    def on_arrays(*arguments: Any) -> Any:
        tensors = [torch.from_numpy(_writable(each)) if isinstance(each, np.ndarray) else each for each in arguments]
        with torch.no_grad():
            result = function(*tensors)
        if any(getattr(tensor, "_version", 0) for tensor in tensors):
            raise ValueError(f"{getattr(function, '__name__', function)}: changes its arguments in place; must compute new "
                             "tensors, as x = x - goal for x -= goal")
        return result

    return on_arrays


class _Memory:
    """The memory of an array, without the mark that it must not be written: torch warns of such arrays."""

    def __init__(self, array: Any) -> None:
        interface = dict(array.__array_interface__)
        interface["data"] = (interface["data"][0], False)
        self.__array_interface__ = interface
        self.array = array  # keeps the memory


def _writable(array: Any) -> Any:
    return array if array.flags.writeable else np.asarray(_Memory(array))


display.describe_all(globals(), __name__)
