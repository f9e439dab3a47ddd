"""Networks of ONNX files, for instance exported by torch, as small networks of Slalom (Debian: python3-onnx)."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import onnx
from onnx import numpy_helper

from .mlp import Mlp, MlpChain

_ACTIVATIONS = {"Tanh": "tanh", "Relu": "relu", "Softplus": "softplus"}


def load_mlp(file: str | os.PathLike[str], *, residual: bool = False) -> Mlp:
    """The Mlp of an ONNX file; `save` writes it for slalom::load_mlp in C++.

    The graph must be a chain from one input [K, n] to one output [K, m]: layers (Gemm, or MatMul and Add), activations
    (Tanh, Relu, Softplus, or Sigmoid and Mul for SiLU), and sums, differences, products and quotients with constants,
    such as a normalisation. Errors name the file and the node.

    residual: whether the network was trained to predict the change of its first inputs
    """
    try:
        graph = onnx.load(os.fspath(file)).graph
    except FileNotFoundError:
        raise
    except Exception as error:  # the parser has no error type of its own
        raise ValueError(f"{file}: is not an ONNX file: {error}") from error
    constants = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
    inputs = [each for each in graph.input if each.name not in constants]
    if len(inputs) != 1 or len(graph.output) != 1:
        raise ValueError(f"{file}: has {len(inputs)} inputs and {len(graph.output)} outputs; must have one of each")
    shape = inputs[0].type.tensor_type.shape.dim
    if len(shape) != 2 or shape[1].dim_value < 1:
        raise ValueError(f"{file}: input {inputs[0].name!r} must have the shape [K, n] with a known n")
    walk = _Walk(shape[1].dim_value, inputs[0].name, constants)
    for node in graph.node:
        try:
            walk.take(node)
        except ValueError as error:
            raise ValueError(f"{file}: node {node.name or node.output[0]!r} ({node.op_type}): {error}") from None
    if walk.value != graph.output[0].name:
        raise ValueError(f"{file}: output {graph.output[0].name!r} is not the end of the chain")
    return walk.chain.network(residual)


class _Walk:
    """Follows one value through the nodes of a graph."""

    def __init__(self, width: int, value: str, constants: dict[str, Any]) -> None:
        self.chain, self.value, self.constants = MlpChain(width), value, constants
        self.sigmoid: str | None = None  # name of the value

    def take(self, node: Any) -> None:
        attributes = {each.name: onnx.helper.get_attribute_value(each) for each in node.attribute}
        operation, inputs = node.op_type, list(node.input)
        if operation == "Constant":
            if "value" not in attributes:
                raise ValueError("must have a tensor as its value")
            self.constants[node.output[0]] = numpy_helper.to_array(attributes["value"])
            return
        if operation == "Sigmoid" and inputs == [self.value]:
            self.sigmoid = node.output[0]
            return
        if operation == "Mul" and sorted(inputs) == sorted([self.value, self.sigmoid or ""]):
            self.chain.activate("silu")
        else:
            others = [self.constants[each] for each in inputs if each in self.constants]
            if inputs.count(self.value) != 1 or len(others) != len(inputs) - 1:
                raise ValueError("must have the result of the node before it and constants as its inputs")
            self._apply(operation, inputs.index(self.value), others, attributes)
        self.value, self.sigmoid = node.output[0], None

    def _apply(self, operation: str, place: int, others: list[Any], attributes: dict[str, Any]) -> None:
        """`place` is that of the value among the inputs."""
        if operation in _ACTIVATIONS:
            self.chain.activate(_ACTIVATIONS[operation])
        elif operation == "Gemm" and place == 0 and not attributes.get("transA", 0):
            weights = others[0] if attributes.get("transB", 0) else others[0].T
            self.chain.affine(attributes.get("alpha", 1.0) * weights, np.zeros(len(weights)))
            if len(others) > 1:
                self.chain.scale_and_shift(1, attributes.get("beta", 1.0) * others[1])
        elif operation == "MatMul" and place == 0:
            self.chain.affine(others[0].T, np.zeros(others[0].shape[-1]))
        elif operation == "Add":
            self.chain.scale_and_shift(1, others[0])
        elif operation == "Sub":
            self.chain.scale_and_shift(*((1, -others[0]) if place == 0 else (-1, others[0])))
        elif operation == "Mul":
            self.chain.scale_and_shift(others[0], 0)
        elif operation == "Div" and place == 0:
            self.chain.scale_and_shift(1 / np.asarray(others[0], np.float64), 0)
        elif operation != "Identity":
            raise ValueError("is not a part of an Mlp, which has Gemm, MatMul, Add, Sub, Mul, Div, Tanh, Relu, Softplus, "
                             "Sigmoid with Mul, and Identity")
