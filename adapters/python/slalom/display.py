"""The text of problems, controllers and plans, and how problems are pickled.

The classes are compiled. `install` adds the methods here, since text is easier to lay out in Python.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any, Callable, Iterable, Optional

_PROBLEM = ("dynamics", "cost", "terminal_cost", "states", "inputs", "dt", "input_min", "input_max", "input_rate_max",
            "sampler")


def install(solvers: ModuleType) -> None:
    """Adds `__repr__` and `__reduce__` to the classes of the compiled module."""
    for cls in filter(lambda each: isinstance(each, type), vars(solvers).values()):
        if issubclass(cls, solvers.Controller):
            _add(cls, _controller_text)
        elif cls is solvers.Problem:
            _add(cls, _callables_text, lambda problem: (_make, (type(problem), (), _callables(problem))))
        elif cls is solvers.RiskEvaluator:
            _add(cls, _risk_text, lambda risk: (_make, (type(risk), (risk.problem, risk.randomize), risk.options)))
        elif issubclass(cls, solvers.AnyProblem) and cls is not solvers.AnyProblem:
            _add(cls, _problem_text, lambda problem: (_restore, (type(problem), _changed(problem))))
    _add(solvers.Plan, _plan_text)


def _add(cls: type, text: Callable[[Any], str], reduce: Optional[Callable[[Any], Any]] = None) -> None:
    setattr(cls, "__repr__", lambda self: text(self))
    if reduce is not None:
        setattr(cls, "__reduce__", lambda self: reduce(self))


def _make(cls: type, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    return cls(*arguments, **keywords)


def _restore(cls: type, parameters: dict[str, Any]) -> Any:
    problem = cls()
    for name, value in parameters.items():
        setattr(problem, name, value)
    return problem


def _call(name: str, arguments: Iterable[str]) -> str:
    return f"slalom.{name}({', '.join(arguments)})"


def _changed(problem: Any) -> dict[str, Any]:
    """The parameters that differ from their defaults."""
    default = type(problem)()
    named = ((name, member) for cls in type(problem).__mro__ for name, member in vars(cls).items())
    settable = [name for name, member in named if isinstance(member, property) and member.fset]
    return {name: getattr(problem, name) for name in settable if getattr(problem, name) != getattr(default, name)}


def _problem_text(problem: Any) -> str:
    return _call(type(problem).__name__, (f"{name}={value!r}" for name, value in _changed(problem).items()))


def _name(value: Any) -> Any:
    return getattr(value, "__qualname__", repr(value)) if callable(value) else value


def _callables(problem: Any) -> dict[str, Any]:
    return {name: getattr(problem, name) for name in _PROBLEM}


def _callables_text(problem: Any) -> str:
    return _call("Problem", (f"{name}={_name(value)}" for name, value in _callables(problem).items() if value is not None))


def _risk_text(risk: Any) -> str:
    options = (f"{name}={value!r}" for name, value in risk.options.items())
    return _call("RiskEvaluator", [repr(risk.problem), _name(risk.randomize), *options])


def _controller_text(controller: Any) -> str:
    from . import options

    default = {option["name"]: option["default"] for option in options(controller.method)}
    changed = (f"{name}={value!r}" for name, value in controller.options.items() if value != default[name])
    name = type(controller).__name__
    return _call(name, [*[repr(controller.method)] * (name == "Controller"), repr(controller.problem), *changed])


def _plan_text(plan: Any) -> str:
    try:
        status = plan.status
    except RuntimeError:
        return "<slalom.Plan of an earlier solve>"
    return (f"<slalom.Plan {status!r} by {plan.controller.method}: {len(plan.inputs)} steps, cost {plan.cost:.6g}, "
            f"effective sample size {plan.effective_sample_size:.4g} of {len(plan.weights)}, "
            f"{1e3 * plan.times['total']:.3g} ms>")
