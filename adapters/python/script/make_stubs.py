"""Writes type stubs of the compiled modules beside them: python3 make_stubs.py FOLDER"""

import inspect
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[1]).parent))  # PYTHONPATH names the packages of an isolated build of pip
import slalom  # noqa: E402
from slalom import _slalom  # noqa: E402

OPTIONS = {"flag": "bool", "integer": "int", "number": "float", "numbers": "float | Sequence[float]", "choice": "str"}
GENERIC = {"dict": "dict[str, Any]", "tuple": "tuple[Any, ...]", "list": "list[Any]", "object": "Any", "function": "Any"}
HEAD = """import collections.abc
import typing
from typing import Any, Callable, Sequence

import numpy.typing
from numpy.typing import ArrayLike, NDArray
"""


def translate(kind, argument):
    """The Python type for a type in a signature of pybind11, of an argument or of a result."""
    kind = re.sub(r"(slalom\.)?(_slalom|_driving)\.", "", kind)
    if kind == "List[object]" and argument:
        return "Sequence[Any]"
    if kind.startswith("numpy.ndarray") or kind.startswith("List[") and argument:
        return "ArrayLike" if argument else "NDArray[numpy.float64]" if "float64" in kind else "NDArray[Any]"
    if kind.startswith("Union["):
        return " | ".join(translate(part, argument) for part in re.findall(r"[\w.]+(?:\[[^]]*\])?", kind[6:-1]))
    if kind.startswith("Optional["):
        return translate(kind[9:-1], argument) + " | None"
    if kind.startswith("List["):
        return f"list[{translate(kind[5:-1], argument)}]"
    return GENERIC.get(kind, kind)


def argument(text):
    if text.startswith("*") or text == "self":
        return text + ": Any" * text.startswith("**")
    name, _, rest = text.partition(": ")
    if name == "self":
        return name
    kind, default, _ = rest.partition(" = ")
    return f"{name}: {translate(kind, True)}" + " = ..." * bool(default)


def signature(function):
    """Arguments and result, from the signature at the start of a bound function's docstring."""
    match = re.match(r"\w+\((.*)\) -> (.*)$", getattr(function, "declared", function.__doc__ or "").split("\n")[0])
    if not match:
        plain = inspect.signature(function)
        return ", ".join(plain.parameters), "Any"
    return ", ".join(map(argument, filter(None, re.split(r", (?=\w+: |\*)", match[1])))), translate(match[2], False)


def constructor(cls):
    """The arguments of a constructor, whose keyword arguments are options."""
    if hasattr(cls, "_method"):
        return "self, problem: AnyProblem, *" + "".join(f", {option['name']}: {OPTIONS[option['type']]} = ..."
                                                        for option in slalom.options(cls._method))
    arguments = signature(cls.__init__)[0]
    values = [m for m, value in vars(cls).items() if isinstance(value, property) and value.fset]
    if issubclass(cls, _slalom.AnyProblem) and arguments.endswith("**kwargs: Any") and values:
        return arguments.replace("**kwargs: Any", "*") + "".join(f", {m}: {property_type(vars(cls)[m])} = ..." for m in values
                                                               if m != "discs")
    return arguments


def property_type(value):
    """The type of a property, from its getter's signature; of arrays and callables from the docstring."""
    words = value.__doc__ or ""
    match = re.search(r"-> (.*)$", (value.fget.__doc__ or "").split("\n")[0])
    if words.startswith("the callable"):
        return "Callable[..., Any] | None" if "None" in words else "Callable[..., Any]"
    if match and match[1] == "object" and value.fset:
        return "float"
    return translate(match[1], False) if match else "Any"


def class_lines(name, cls):
    base = cls.__mro__[1].__name__
    yield f"class {name}({base}):" if base not in ("object", "pybind11_object") else f"class {name}:"
    yield f'    """{(cls.__doc__ or "").strip()}"""'
    for member, value in vars(cls).items():
        if isinstance(value, property):
            kind = property_type(value)
            words = (value.__doc__ or "").strip().replace('"', "'")
            yield f'    @property\n    def {member}(self) -> {kind}:\n        """{words}"""'
            if value.fset:
                setter = "Sequence[Sequence[float]]" if kind.startswith("list") else kind
                yield f"    @{member}.setter\n    def {member}(self, value: {setter}) -> None: ..."
        elif member == "__init__" and "->" in (value.__doc__ or ""):
            yield f"    def __init__({constructor(cls)}) -> None: ..."
        elif not member.startswith("_") and callable(getattr(value, "__func__", value)):
            function = getattr(value, "__func__", value)
            arguments, result = signature(function)
            if isinstance(value, staticmethod):
                yield "    @staticmethod"
            words = (function.__doc__ or "").replace("\\", "").replace('"', "'")
            yield f'    def {member}({arguments}) -> {result}:\n        """{words}"""'


def stub(module):
    lines = [HEAD]
    if module is _slalom:
        lines += ["__version__: str", ""]
    else:
        lines += ["from slalom._slalom import OccupancyGrid", ""]
    for name, value in sorted(vars(module).items()):
        if name.startswith("_"):
            continue
        if inspect.isclass(value) and issubclass(value, Exception):
            lines += [f"class {name}(OSError): ...", ""]
        elif inspect.isclass(value):
            lines += [*class_lines(name, value), ""]
        else:
            arguments, result = signature(value)
            lines += [f'def {name}({arguments}) -> {result}:\n    """{value.__doc__}"""', ""]
    return "\n".join(lines)


def main(folder):
    for module in (slalom._slalom, slalom._driving):
        if module is None:
            continue
        file = Path(folder) / f"{module.__name__.split('.')[-1]}.pyi"
        text = stub(module)
        compile(text, file, "exec")
        file.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1])
