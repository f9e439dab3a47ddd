"""The text of problems, controllers and plans, how problems are pickled, and what `inspect.signature` says.

The classes are compiled. `install` adds the methods here, since text is easier to lay out in Python. Docstrings get the forms
and units of arguments and results from `reference.md`, which is docs/python-reference.md.
"""

from __future__ import annotations

import ast
import copyreg
import functools
import inspect
import re
from pathlib import Path
from types import ModuleType
from typing import Any, Callable, Dict, Iterable, Tuple

from . import plot

_option_names: set[str] = set()  # names of the options of all methods

_reference = {row[0].strip("`"): row[1:] for row in ([cell.strip() for cell in line.strip("|").split(" |")] for line in
              Path(__file__).with_name("reference.md").read_text().splitlines() if line.startswith("| `"))}

Arguments = Tuple[Tuple[Any, ...], Dict[str, Any]]  # arguments by position and by name


class Options(Dict[str, Any]):
    """The options of a controller by name. They cannot be changed: a change would have no effect."""

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError("the options of a controller cannot be changed; make another one with "
                        "type(controller)(controller.problem, **{**controller.options, 'temperature': 0.1})")

    def __reduce__(self) -> Any:
        return dict, (dict(self),)


for _name in ("__setitem__", "__delitem__", "__ior__", "update", "pop", "popitem", "setdefault", "clear"):
    setattr(Options, _name, getattr(Options, "_refuse"))


def install(solvers: ModuleType) -> None:
    """Adds `__repr__` and `__reduce__` to the classes of the compiled module, and signatures to their methods."""
    _option_names.update(option["name"] for method in solvers.methods() for option in solvers.options(method))
    arguments: dict[type, Callable[[Any], Arguments]] = {solvers.Problem: lambda problem: ((), {name: getattr(problem, name)
                                               for name in inspect.signature(solvers.Problem).parameters}),
        solvers.RiskEvaluator: lambda risk: ((risk.problem, risk.randomize), risk.options),
        solvers.CompiledProblem: lambda problem: ((problem.file,), problem.parameters)}
    add_signatures(solvers)
    for cls in [each for each in vars(solvers).values() if isinstance(each, type)]:
        if issubclass(cls, solvers.Controller):
            setattr(cls, "__repr__", _controller_text)
            setattr(cls, "__setattr__", _refuse_attribute)
        elif issubclass(cls, solvers.AnyProblem) and cls is not solvers.AnyProblem:
            _constructed(cls, arguments.get(cls, lambda problem: ((), changed(problem))))
    setattr(solvers.Plan, "__repr__", _plan_text)
    setattr(solvers.Field, "__repr__", lambda field: f"<slalom.Field {field.shape[0]} x {field.shape[1]} of {field.resolution} m>")
    setattr(solvers.Plan, "_repr_png_", lambda plan: plot._png(plot.plan, plan))


def add_methods(solvers: ModuleType) -> None:
    """Adds the class of each method, derived from `Controller`: SvgMppi for svg_mppi."""
    base = solvers.Controller

    def make(self: Any, problem: Any, **options: Any) -> None:
        """__init__(self: object, problem: object, **kwargs) -> None"""
        base.__init__(self, type(self)._method, problem, **options)

    for method in solvers.methods():
        name = "".join(word.capitalize() for word in method.split("_"))
        text = (f"A controller that solves its problem by the method `{method}`.\n\nThe problem is copied: `controller.problem` "
                "is the copy, whose parameters may change between solves.")
        setattr(solvers, name, type(base)(name, (base,), {
            "__module__": solvers.__name__, "__doc__": text + getattr(solvers, "_options_text")(method), "__init__": make,
            "_method": method}))


def set_pickles(module: ModuleType) -> None:
    """Sets `__reduce__` of the compiled classes: that of Python would make objects without their compiled part, which
    end the interpreter."""
    for cls in [each for each in vars(module).values() if isinstance(each, type) and not issubclass(each, Exception)]:
        if hasattr(cls, "__setstate__"):
            setattr(cls, "__reduce__", lambda self: (copyreg.__newobj__, (type(self),), self.__getstate__()))  # type: ignore[attr-defined]
        elif cls.__reduce__ is object.__reduce__:
            setattr(cls, "__reduce__", _refuse_pickle)


def _refuse_pickle(self: Any) -> Any:
    raise TypeError(f"cannot pickle or copy a slalom.{type(self).__name__}")


def _refuse_attribute(controller: Any, name: str, value: Any) -> None:
    """Sets an attribute of a user's class. Raises AttributeError for an option, which cannot be changed."""
    known = name in _option_names
    if known or type(controller).__module__.startswith("slalom"):
        raise AttributeError(f"{type(controller).__name__}.{name} cannot be set; make another controller with "
                             f"type(controller)(controller.problem, **{{**controller.options, '{name}': {value!r}}})"
                             if known else f"{type(controller).__name__} has no attribute '{name}' that can be set")
    object.__setattr__(controller, name, value)


def add_signatures(module: ModuleType) -> None:
    """Wraps the compiled functions of a module and its classes in those whose signatures Python can tell."""
    for each in [module, *(value for value in vars(module).values() if isinstance(value, type))]:
        _add_signatures(module, each)


def _add_signatures(solvers: ModuleType, cls: Any) -> None:
    for name, method in list(vars(cls).items()):
        function = getattr(method, "__func__", method)
        first = re.match(r"\w+\((.*)\) -> ", getattr(function, "__doc__", None) or "")
        if isinstance(method, property) and method.fset:
            setattr(cls, name, method.setter(_with_signature(method.fset, [])))
        elif first and (name == "__init__" or not name.startswith("_")) and not isinstance(method, type):
            wrapped = _with_signature(function, _parameters(cls, first[1]))
            setattr(cls, name, staticmethod(wrapped) if isinstance(method, staticmethod) else wrapped)


def describe_all(values: dict[str, Any], module: str = "") -> None:
    """Describes functions and classes, with `module` those that it defines."""
    place = f"{module.rpartition('.')[2]}." if module else ""
    for name, value in values.items():
        if callable(value) and not name.startswith("_") and module in ("", getattr(value, "__module__", None)):
            describe(place + name, value)


def describe(name: str, value: Any) -> None:
    """Adds the sections of numpy's style that docstrings lack to those of a function, or of a class and its functions."""
    for member, function in list(vars(value).items()) * isinstance(value, type):
        if not member.startswith("_") and inspect.isroutine(getattr(value, member)):
            describe(f"{name}.{member}", getattr(function, "__func__", function))
    text, rows = inspect.cleandoc(value.__doc__ or ""), ""
    if compiled := re.match(r"\w+\(.*\) -> .*\n*", text):
        setattr(value, "declared", compiled[0])
        text = text[compiled.end():]
    told = ", ".join(re.findall(r"^[\w, ]+(?= : )", text.partition("Attributes\n---")[0], re.M)).split(", ")
    try:
        parameters = [*inspect.signature(value).parameters.values()]
    except ValueError:  # made by no call
        parameters = []
    for each in parameters:
        form, meaning = _reference.get(f"{name}: {each.name}") or _reference.get(each.name) or ("", "")
        value_text = f", default {each.default}" if len(str(each.default)) < 20 else ", optional"
        default = "" if each.default in (each.empty, None) or "optional" in form else value_text
        rows += f"{each.name} : {form}{default}\n    {meaning}\n" * (bool(form) and each.name not in told)
    if rows and "Parameters\n---" not in text:
        text += "\n\nParameters\n----------\n"
    text = text.replace("Parameters\n----------\n", f"Parameters\n----------\n{rows}", 1).rstrip()
    for title, words in zip(("Returns", "Raises"), _reference.get(name, ())):
        lines = [f"{kind}\n    {meaning}" for kind, _, meaning in (each.partition(": ") for each in words.split(". ") if each)]
        text += "\n".join(["", "", title, "-" * len(title), *lines]) * bool(lines and f"{title}\n---" not in text)
    value.__doc__ = text


def _with_signature(function: Callable[..., Any], parameters: list[inspect.Parameter]) -> Callable[..., Any]:
    @functools.wraps(function)
    def method(*arguments: Any, **named: Any) -> Any:
        try:
            return function(*arguments, **named)
        except TypeError as error:  # that of pybind11 ends with all values, however long
            raise error if len(str(error)) < 1000 else TypeError(f"{str(error)[:990]} ...")

    setattr(method, "__signature__", inspect.Signature(parameters))
    return method


def _parameters(cls: type, text: str) -> list[inspect.Parameter]:
    """The parameters in the first line of a compiled function's docstring; for `**kwargs`, the options of the class."""
    found: list[inspect.Parameter] = []
    kind: Any = inspect.Parameter.POSITIONAL_OR_KEYWORD
    for part in filter(None, re.split(r", (?=\w+: |\*)", text)):
        if part.startswith("*"):
            kind = inspect.Parameter.KEYWORD_ONLY
            if part.startswith("**"):
                found += [inspect.Parameter(option, kind, default=_value(default)) for option, default in
                          re.findall(r"^(\w+) : .*default (.+)$", cls.__doc__ or "", re.M)]
            continue
        name, _, rest = part.partition(":")
        value = rest.partition(" = ")[2]
        found.append(inspect.Parameter(name, kind, default=_value(value) if value else inspect.Parameter.empty))
    return found


def _value(text: str) -> Any:
    """The value of a default in a docstring; the text if it is not a literal."""
    try:
        return float(text) if text.lstrip("-") == "inf" else ast.literal_eval(text)
    except (SyntaxError, ValueError):
        return text


def _settable(cls: type) -> list[str]:
    return [name for each in cls.__mro__ for name, member in vars(each).items() if isinstance(member, property) and member.fset]


def _constructed(cls: type, arguments: Callable[[Any], Arguments]) -> None:
    """Makes the text and the pickle of an object from the arguments that construct it."""
    setattr(cls, "__repr__", lambda self: _call(cls.__name__, *arguments(self)))
    setattr(cls, "__reduce__", lambda self: (_make, (type(self), *arguments(self))))


def _make(cls: type, positional: tuple[Any, ...], named: dict[str, Any]) -> Any:
    discs = None if cls.__name__ == "CompiledProblem" else named.pop("discs", None)  # an attribute, but no argument
    made = cls(*positional, **named)
    if discs is not None:
        setattr(made, "discs", discs)
    return made


def _call(name: str, positional: Iterable[Any], named: dict[str, Any]) -> str:
    def text(value: Any) -> Any:
        return getattr(value, "__qualname__", repr(value))

    arguments = [*map(text, positional), *(f"{key}={text(value)}" for key, value in named.items() if value is not None)]
    return f"slalom.{name}({', '.join(arguments)})"


def takes_k(function: Callable[..., Any]) -> bool:
    """Whether a callable has a third argument without a default: the index of the step. False if it does not tell."""
    try:
        parameters = list(inspect.signature(function).parameters.values())[2:3]
    except (TypeError, ValueError):
        return False
    return bool(parameters) and parameters[0].default is inspect.Parameter.empty and parameters[0].kind in (
        inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


def changed(problem: Any) -> dict[str, Any]:
    """The parameters that differ from their defaults."""
    default = type(problem)()
    return {name: getattr(problem, name) for name in _settable(type(problem)) if getattr(problem, name) != getattr(default, name)}


def _controller_text(controller: Any) -> str:
    from . import options

    default = {option["name"]: option["default"] for option in options(controller.method)}
    changed = {name: value for name, value in controller.options.items() if value != default[name]}
    name = "gpu." * (type(controller).__module__ == "slalom.gpu") + type(controller).__name__
    return _call(name, [*[controller.method] * (name == "Controller"), controller.problem], changed)


def _plan_text(plan: Any) -> str:
    try:
        status = plan.status
    except RuntimeError:
        return "<slalom.Plan of an earlier solve>"
    return (f"<slalom.Plan {status!r} by {plan.controller.method}: {len(plan.inputs)} steps, cost {plan.cost:.6g}, "
            f"effective sample size {plan.effective_sample_size:.4g} of {len(plan.weights)}, "
            f"{1e3 * plan.times['total']:.3g} ms>")
