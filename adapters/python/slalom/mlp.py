"""Small neural networks for learned dynamics: trained with numpy, stored for slalom::Mlp in C++."""

from __future__ import annotations

import os
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _slalom, display

Array = NDArray[Any]

_ACTIVATIONS = ("tanh", "relu", "softplus", "silu")


def _sigmoid(x: Array) -> Array:
    result: Array = np.exp(-np.logaddexp(0, -x))
    return result


def _activate(name: str, x: Array) -> tuple[Array, Array]:
    """The activation and its derivative."""
    if name == "tanh":
        y = np.tanh(x)
        return y, 1 - y * y
    if name == "relu":
        return np.maximum(x, 0), (x > 0).astype(x.dtype)
    if name == "softplus":
        return np.logaddexp(0, x).astype(x.dtype), _sigmoid(x)
    s = _sigmoid(x)
    return x * s, s + x * s * (1 - s)


class Mlp:
    """A network of dense layers. `network(x)` returns the outputs [K, outputs] for inputs [K, inputs].
    It computes with (x - input_mean) / input_scale, multiplies by output_scale and adds output_mean."""

    def __init__(self, layers: Sequence[tuple[ArrayLike, ArrayLike]], activation: str = "tanh", *,
                 input_mean: ArrayLike | None = None, input_scale: ArrayLike | None = None,
                 output_mean: ArrayLike | None = None, output_scale: ArrayLike | None = None, residual: bool = False) -> None:
        if activation not in _ACTIVATIONS:
            raise ValueError(f"Mlp.activation: {activation!r} must be one of {', '.join(_ACTIVATIONS)}")
        self.layers = [(np.array(w, np.float32), np.array(b, np.float32)) for w, b in layers]
        self.activation = activation
        inputs, outputs = self.layers[0][0].shape[1], self.layers[-1][0].shape[0]
        self.input_mean = np.zeros(inputs, np.float32) if input_mean is None else np.array(input_mean, np.float32)
        self.input_scale = np.ones(inputs, np.float32) if input_scale is None else np.array(input_scale, np.float32)
        self.output_mean = np.zeros(outputs, np.float32) if output_mean is None else np.array(output_mean, np.float32)
        self.output_scale = np.ones(outputs, np.float32) if output_scale is None else np.array(output_scale, np.float32)
        self.residual = bool(residual)

    def __call__(self, x: ArrayLike) -> Array:
        x = np.asarray(x)
        y = (x - self.input_mean) / self.input_scale
        for weights, biases in self.layers[:-1]:
            y, _ = _activate(self.activation, y @ weights.T + biases)
        weights, biases = self.layers[-1]
        y = (y @ weights.T + biases) * self.output_scale + self.output_mean
        result: Array = y + x[:, :y.shape[1]] if self.residual else y
        return result

    def __repr__(self) -> str:
        sizes = [self.layers[0][0].shape[1], *(len(biases) for _, biases in self.layers)]
        return (f"<slalom.mlp.Mlp {' -> '.join(map(str, sizes))}, {self.activation}{', residual' if self.residual else ''}>")

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the network to a file for `slalom::load_mlp` and `Mlp.load`."""
        arrays: dict[str, Any] = {"activation": np.array(self.activation), "residual": np.array(self.residual)}
        for name in "input_mean", "input_scale", "output_mean", "output_scale":
            arrays[name] = getattr(self, name)
        for i, (weights, biases) in enumerate(self.layers):
            arrays[f"weights_{i}"], arrays[f"biases_{i}"] = map(np.ascontiguousarray, (weights, biases))
        with open(file, "wb") as stream:
            np.savez(stream, **arrays)

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Mlp:
        """The network that `save` wrote, read as `slalom::load_mlp` does. Raises slalom.IoError."""
        read = getattr(_slalom, "_read_mlp")(os.fspath(file))
        return cls(activation=_ACTIVATIONS[read.pop("activation")], **read)


def train_mlp(inputs: ArrayLike, outputs: ArrayLike, *, hidden: Sequence[int] = (32, 32), activation: str = "tanh",
              residual: bool = False, epochs: int = 200, batch: int = 256, learning_rate: float = 3e-3, seed: int = 0) -> Mlp:
    """An Mlp that maps inputs [K, n] to outputs [K, m] with the least mean squared error, of normalised outputs.

    Adam (Kingma and Ba, 2015) on batches, with a learning rate that falls to 0 along a cosine. With `residual` the
    network learns the differences between the outputs and the first m inputs: use it to learn the next state.
    The same data and seed give the same network."""
    inputs, outputs = np.asarray(inputs, np.float64), np.asarray(outputs, np.float64)
    if inputs.ndim != 2 or outputs.ndim != 2 or len(inputs) != len(outputs) or len(inputs) == 0:
        raise ValueError(f"train_mlp: inputs {inputs.shape} and outputs {outputs.shape} must be arrays [K, n] and [K, m]")
    if not (np.isfinite(inputs).all() and np.isfinite(outputs).all()):
        raise ValueError("train_mlp: every input and output must be finite")
    if residual and outputs.shape[1] > inputs.shape[1]:
        raise ValueError("train_mlp: residual needs at least as many columns of inputs as of outputs")
    for name, value, least in [("epochs", epochs, 0), ("batch", batch, 1), *(("hidden", size, 1) for size in hidden)]:
        if not (isinstance(value, (int, np.integer)) and value >= least):
            raise ValueError(f"train_mlp: {name}: {value} must be an integer of at least {least}")
    if not 0 < learning_rate < np.inf:
        raise ValueError(f"train_mlp: learning_rate: {learning_rate} must be finite and above 0")
    target = outputs - inputs[:, :outputs.shape[1]] if residual else outputs
    (input_mean, input_scale), (output_mean, output_scale) = map(_normalisation, (inputs, target))
    x, y = (inputs - input_mean) / input_scale, (target - output_mean) / output_scale
    output_scale = np.where(np.ptp(target, axis=0) > 0, output_scale, 0)  # a constant output is its mean

    random = np.random.default_rng(seed)
    sizes = [x.shape[1], *hidden, y.shape[1]]
    parameters = []
    for entering, leaving in zip(sizes, sizes[1:]):
        parameters += [random.normal(0, np.sqrt(1 / entering), (leaving, entering)), np.zeros(leaving)]
    first, second = ([np.zeros_like(p) for p in parameters] for _ in range(2))
    step, steps = 0, epochs * -(-len(x) // batch)
    for _ in range(epochs):
        order = random.permutation(len(x))
        for start in range(0, len(x), batch):
            chosen = order[start:start + batch]
            step += 1
            rate = learning_rate * 0.5 * (1 + np.cos(np.pi * step / steps))
            for i, gradient in enumerate(_gradients(parameters, activation, x[chosen], y[chosen])):
                first[i] += 0.1 * (gradient - first[i])
                second[i] += 0.001 * (gradient * gradient - second[i])
                parameters[i] -= rate * (first[i] / (1 - 0.9**step)) / (np.sqrt(second[i] / (1 - 0.999**step)) + 1e-8)
    return Mlp(list(zip(parameters[::2], parameters[1::2])), activation, input_mean=input_mean, input_scale=input_scale,
               output_mean=output_mean, output_scale=output_scale, residual=residual)


def _normalisation(values: Array) -> tuple[Array, Array]:
    """Mean and standard deviation of each column; 1 for a column that does not vary."""
    scale = values.std(axis=0)
    return values.mean(axis=0), np.where(scale > 1e-12 * (1 + np.abs(values).max(axis=0)), scale, 1)


def _gradients(parameters: list[Array], activation: str, x: Array, y: Array) -> list[Array]:
    """Derivatives of half the mean squared error by all parameters, by backpropagation."""
    entering, slopes = [x], []
    for weights, biases in zip(parameters[:-2:2], parameters[1:-2:2]):
        value, slope = _activate(activation, entering[-1] @ weights.T + biases)
        entering.append(value)
        slopes.append(slope)
    error: Any = (entering[-1] @ parameters[-2].T + parameters[-1] - y) / len(x)
    gradients = []
    for layer in reversed(range(len(entering))):
        gradients += [error.sum(axis=0), error.T @ entering[layer]]
        if layer:
            error = error @ parameters[2 * layer] * slopes[layer - 1]
    return gradients[::-1]


display.describe_all(globals(), __name__)
