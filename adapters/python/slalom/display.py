"""The text of problems, controllers and plans, and how problems are pickled.

The classes are compiled. `install` adds the methods here, since text is easier to lay out in Python.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any, Callable, Dict, Iterable, Tuple

_PARTS = ("dynamics", "cost", "terminal_cost", "states", "inputs", "dt", "input_min", "input_max", "input_rate_max",
          "sampler")

Arguments = Tuple[Tuple[Any, ...], Dict[str, Any]]  # arguments by position and by name


def install(solvers: ModuleType) -> None:
    """Adds `__repr__` and `__reduce__` to the classes of the compiled module."""
    for cls in filter(lambda each: isinstance(each, type), vars(solvers).values()):
        if issubclass(cls, solvers.Controller):
            setattr(cls, "__repr__", _controller_text)
        elif cls is solvers.Problem:
            _constructed(cls, lambda problem: ((), {name: getattr(problem, name) for name in _PARTS}))
        elif cls is solvers.RiskEvaluator:
            _constructed(cls, lambda risk: ((risk.problem, risk.randomize), risk.options))
        elif issubclass(cls, solvers.AnyProblem) and cls is not solvers.AnyProblem:
            _constructed(cls, lambda problem: ((), _changed(problem)))
    setattr(solvers.Plan, "__repr__", _plan_text)


def _constructed(cls: type, arguments: Callable[[Any], Arguments]) -> None:
    """Makes the text and the pickle of an object from the arguments that construct it."""
    setattr(cls, "__repr__", lambda self: _call(cls.__name__, *arguments(self)))
    setattr(cls, "__reduce__", lambda self: (_make, (type(self), *arguments(self))))


def _make(cls: type, positional: tuple[Any, ...], named: dict[str, Any]) -> Any:
    discs = named.pop("discs", None)  # an attribute, but no argument
    made = cls(*positional, **named)
    if discs is not None:
        setattr(made, "discs", discs)
    return made


def _call(name: str, positional: Iterable[Any], named: dict[str, Any]) -> str:
    def text(value: Any) -> Any:
        return getattr(value, "__qualname__", repr(value))

    arguments = [*map(text, positional), *(f"{key}={text(value)}" for key, value in named.items() if value is not None)]
    return f"slalom.{name}({', '.join(arguments)})"


def _changed(problem: Any) -> dict[str, Any]:
    """The parameters that differ from their defaults."""
    default = type(problem)()
    named = ((name, member) for cls in type(problem).__mro__ for name, member in vars(cls).items())
    settable = [name for name, member in named if isinstance(member, property) and member.fset]
    return {name: getattr(problem, name) for name in settable if getattr(problem, name) != getattr(default, name)}


def _controller_text(controller: Any) -> str:
    from . import options

    default = {option["name"]: option["default"] for option in options(controller.method)}
    changed = {name: value for name, value in controller.options.items() if value != default[name]}
    name = type(controller).__name__
    return _call(name, [*[controller.method] * (name == "Controller"), controller.problem], changed)


def _plan_text(plan: Any) -> str:
    try:
        status = plan.status
    except RuntimeError:
        return "<slalom.Plan of an earlier solve>"
    return (f"<slalom.Plan {status!r} by {plan.controller.method}: {len(plan.inputs)} steps, cost {plan.cost:.6g}, "
            f"effective sample size {plan.effective_sample_size:.4g} of {len(plan.weights)}, "
            f"{1e3 * plan.times['total']:.3g} ms>")
