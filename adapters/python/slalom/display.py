"""How the classes of the package show themselves, as text and in notebooks, and how they are pickled.

The classes are compiled. `install` adds the methods here, since text is easier to lay out in Python.
"""

from __future__ import annotations

import html
from types import ModuleType
from typing import Any, Callable, Optional

_PROBLEM = ("dynamics", "cost", "terminal_cost", "states", "inputs", "dt", "input_min", "input_max", "input_rate_max",
            "sampler")


def install(solvers: ModuleType, driving: Optional[ModuleType]) -> None:
    """Adds `__repr__`, `_repr_html_` and `__reduce__` to the classes of the compiled modules."""
    for name, cls in vars(solvers).items():
        if not isinstance(cls, type):
            continue
        if issubclass(cls, solvers.Controller):
            _add(cls, _controller_text, _controller_rows, _reduce_controller)
        elif cls is solvers.Problem:
            _add(cls, _callables_text, _callables_rows, _reduce_callables)
        elif cls is solvers.RiskEvaluator:
            _add(cls, _risk_text, _risk_rows, _reduce_risk)
        elif issubclass(cls, solvers.AnyProblem) and cls is not solvers.AnyProblem:
            _add(cls, _problem_text, _problem_rows, _reduce_problem)
    _add(solvers.Plan, _plan_text, _plan_rows)
    _add(solvers.SolveResult, _result_text, _result_rows)
    _add(solvers.Linearization, lambda e: _expansion_text(e, "Linearization"), _expansion_rows)
    _add(solvers.TerminalExpansion, lambda e: _expansion_text(e, "TerminalExpansion"), _expansion_rows)
    _add(solvers.Feedback, lambda f: f"<slalom.Feedback: gains [{', '.join(map(str, f.gains.shape))}]>")
    _add(solvers.Ilqr, lambda i: f"<slalom.Ilqr: cost {i.cost:.6g}, {i.iterations} iterations>")
    _add(solvers.OccupancyGrid, _grid_text)
    if driving:
        _add(driving.Course, lambda c: f"<slalom.Course {c.name!r}: {c.length:.2f} m, {len(c.waypoints)} waypoints>")
        _add(driving.World, lambda w: f"<slalom.World: {w.cars} driven cars, {w.time:g} s>", lambda w: w.options.items())
        _add(driving.RacingCar, lambda c: f"<slalom.RacingCar {c.name!r}: {c.width:g} m wide>")


def _add(cls: type, text: Callable[[Any], str], rows: Optional[Callable[[Any], Any]] = None,
         reduce: Optional[Callable[[Any], Any]] = None) -> None:
    setattr(cls, "__repr__", lambda self: text(self))
    if rows is not None:
        setattr(cls, "_repr_html_", lambda self: _table(text(self), rows(self)))
    if reduce is not None:
        setattr(cls, "__reduce__", lambda self: reduce(self))


def _table(caption: str, rows: Any) -> str:
    cells = "".join(f"<tr><th style='text-align:left'>{html.escape(str(name))}</th><td>{html.escape(_short(value))}</td></tr>"
                    for name, value in rows)
    return f"<table><caption>{html.escape(caption)}</caption>{cells}</table>"


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return f"{value.dtype} [{', '.join(map(str, value.shape))}]"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_short(part)}" for name, part in value.items())
    return str(value)


def _call(name: str, arguments: Any) -> str:
    return f"slalom.{name}({', '.join(arguments)})"


# Problems


def _parameters(problem: Any) -> dict[str, Any]:
    """The parameters that can be set, by name."""
    named = ((name, member) for cls in type(problem).__mro__ for name, member in vars(cls).items())
    return {name: getattr(problem, name) for name, member in named if isinstance(member, property) and member.fset}


def _changed(problem: Any) -> dict[str, Any]:
    default = type(problem)()
    return {name: value for name, value in _parameters(problem).items() if value != getattr(default, name)}


def _problem_text(problem: Any) -> str:
    return _call(type(problem).__name__, (f"{name}={value!r}" for name, value in _changed(problem).items()))


def _problem_rows(problem: Any) -> Any:
    return [("states", problem.states), ("inputs", problem.inputs), *_parameters(problem).items()]


def _restore_problem(cls: type, parameters: dict[str, Any]) -> Any:
    problem = cls()
    for name, value in parameters.items():
        setattr(problem, name, value)
    return problem


def _reduce_problem(problem: Any) -> Any:
    return _restore_problem, (type(problem), _changed(problem))


def _callable_name(function: Any) -> str:
    return getattr(function, "__qualname__", repr(function))


def _callables_rows(problem: Any) -> Any:
    values = ((name, getattr(problem, name)) for name in _PROBLEM)
    return [(name, _callable_name(value) if callable(value) else value) for name, value in values if value is not None]


def _callables_text(problem: Any) -> str:
    return _call("Problem", (f"{name}={value}" for name, value in _callables_rows(problem)))


def _restore_callables(cls: type, parts: dict[str, Any]) -> Any:
    return cls(**parts)


def _reduce_callables(problem: Any) -> Any:
    return _restore_callables, (type(problem), {name: getattr(problem, name) for name in _PROBLEM})


def _risk_rows(risk: Any) -> Any:
    return [("problem", repr(risk.problem)), ("randomize", _callable_name(risk.randomize)), *risk.options.items()]


def _risk_text(risk: Any) -> str:
    options = (f"{name}={value!r}" for name, value in risk.options.items())
    return _call("RiskEvaluator", [repr(risk.problem), _callable_name(risk.randomize), *options])


def _restore_risk(cls: type, problem: Any, randomize: Any, options: dict[str, Any]) -> Any:
    return cls(problem, randomize, **options)


def _reduce_risk(risk: Any) -> Any:
    return _restore_risk, (type(risk), risk.problem, risk.randomize, risk.options)


# Controllers


def _controller_text(controller: Any) -> str:
    from . import options

    default = {option["name"]: option["default"] for option in options(controller.method)}
    changed = (f"{name}={value!r}" for name, value in controller.options.items() if value != default[name])
    name = type(controller).__name__
    method = [repr(controller.method)] if name == "Controller" else []
    return _call(name, [*method, repr(controller.problem), *changed])


def _controller_rows(controller: Any) -> Any:
    return [("method", controller.method), ("problem", repr(controller.problem)), *controller.options.items()]


def _restore_controller(cls: type, method: str, problem: Any, options: dict[str, Any]) -> Any:
    return cls(*([method] if cls.__name__ == "Controller" else []), problem, **options)


def _reduce_controller(controller: Any) -> Any:
    return _restore_controller, (type(controller), controller.method, controller.problem, controller.options)


# Results


def _is_stale(plan: Any) -> bool:
    try:
        return plan.status is None
    except RuntimeError:
        return True


def _plan_text(plan: Any) -> str:
    if _is_stale(plan):
        return "<slalom.Plan of an earlier solve>"
    return (f"<slalom.Plan {plan.status!r} by {plan.controller.method}: {len(plan.inputs)} steps, cost {plan.cost:.6g}, "
            f"effective sample size {plan.effective_sample_size:.4g} of {len(plan.weights)}, "
            f"{1e3 * plan.times['total']:.3g} ms>")


def _plan_rows(plan: Any) -> Any:
    if _is_stale(plan):
        return []
    names = ("status", "cost", "cost_terms", "collided", "inputs", "states", "effective_sample_size", "collided_share",
             "minimum_cost", "iterations", "times")
    return [("first input", ", ".join(f"{u:.6g}" for u in plan.inputs[0])), *((name, getattr(plan, name)) for name in names)]


def _result_text(result: Any) -> str:
    if _is_stale(result):
        return "<slalom.SolveResult of an earlier solve>"
    return (f"<slalom.SolveResult {result.status!r}: effective sample size {result.effective_sample_size:.4g} of "
            f"{len(result.weights)}, lowest cost {result.minimum_cost:.6g}>")


def _members(shown: Any) -> Any:
    return [(name, getattr(shown, name)) for name, member in vars(type(shown)).items() if isinstance(member, property)]


def _result_rows(result: Any) -> Any:
    return [] if _is_stale(result) else _members(result)


def _expansion_text(expansion: Any, name: str) -> str:
    return f"<slalom.{name}: {len(expansion.state_gradient)} states, cost {expansion.cost:.6g}, kink {expansion.kink}>"


def _expansion_rows(expansion: Any) -> Any:
    return _members(expansion)


def _grid_text(grid: Any) -> str:
    rows, columns = grid.cells.shape
    return f"<slalom.OccupancyGrid {rows} x {columns} of {grid.resolution:g} m>"
