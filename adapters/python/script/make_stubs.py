"""Writes type stubs of the compiled module: python3 make_stubs.py OUT.pyi"""

import inspect
import re
import sys

import slalom
from slalom import _slalom

TYPES = {"flag": "bool", "integer": "int", "number": "float", "numbers": "float | Sequence[float]", "choice": "str"}
METHOD_OF = {"".join(word.capitalize() for word in method.split("_")): method for method in slalom.methods()}


def keyword(option):
    return f"{option['name']}: {TYPES[option['type']]} = ..."


def signature(function):
    """The signature at the start of a bound function's docstring."""
    first = (function.__doc__ or "").split("\n")[0]
    match = re.match(r"\w+\((.*)\) -> (.*)$", first)
    if not match:
        return "*args: Any, **kwargs: Any", "Any"
    arguments = re.sub(r"_slalom\.", "", match[1])
    arguments = re.sub(r"self: [\w.]+", "self", arguments)
    arguments = re.sub(r"(List|Dict|Tuple)\[", lambda m: m[1].lower() + "[", arguments)
    arguments = re.sub(r"numpy\.ndarray(\[[^\]]*\])?", "Any", arguments)
    arguments = re.sub(r": [^,=]*\[[^=]*?\]\]?( = |,|$)", r": Any\1", arguments)
    arguments = re.sub(r" = [^,)]+(\[[^\]]*\])?", " = ...", arguments)
    result = re.sub(r"_slalom\.|numpy\.", "", match[2])
    result = re.sub(r"List\[", "list[", result)
    return arguments, "NDArray[Any]" if result.startswith("ndarray") or result == "array" else result


def property_type(value):
    """The type of a property, from its getter's signature; of arrays from the docstring."""
    first = (value.fget.__doc__ or "").split("\n")[0]
    match = re.search(r"-> (.*)$", first)
    if re.match(r"(float32|float64|uint8) \[", value.__doc__ or ""):
        return "NDArray[Any]"
    if not match or match[1] == "object":
        return "Any"
    result = re.sub(r"_slalom\.|slalom\.", "", match[1])
    if result.startswith("numpy.ndarray"):
        return "NDArray[Any]"
    return re.sub(r"(List|Dict|Tuple)\b", lambda m: m[1].lower(), result)


def class_lines(name, cls):
    base = cls.__mro__[1].__name__
    yield f"class {name}({base}):" if not base.startswith("pybind11") else f"class {name}:"
    yield f'    """{(cls.__doc__ or "").strip()}"""'
    if name in METHOD_OF:
        options = ", ".join(keyword(option) for option in slalom.options(METHOD_OF[name]))
        yield f"    def __init__(self, problem: AnyProblem, *, {options}) -> None: ..."
    for member, value in vars(cls).items():
        if isinstance(value, property):
            kind = property_type(value)
            words = (value.__doc__ or "").strip().replace('"', "'")
            yield f'    @property\n    def {member}(self) -> {kind}:\n        """{words}"""'
            if value.fset:
                yield f"    @{member}.setter\n    def {member}(self, value: Any) -> None: ..."
        elif member == "__init__" and name not in METHOD_OF:
            arguments, _ = signature(value)
            yield f"    def __init__({arguments or 'self'}) -> None: ..."
        elif not member.startswith("_") and callable(value):
            arguments, result = signature(getattr(value, "__func__", value))
            if isinstance(value, staticmethod):
                yield "    @staticmethod"
            yield f"    def {member}({arguments}) -> {result}: ..."


def main(out):
    lines = ["from typing import Any, Sequence", "", "from numpy.typing import NDArray", "", "__version__: str", ""]
    for name in dir(_slalom):
        value = getattr(_slalom, name)
        if name.startswith("_"):
            continue
        if inspect.isclass(value) and issubclass(value, Exception):
            lines += [f"class {name}(OSError): ...", ""]
        elif inspect.isclass(value):
            lines += [*class_lines(name, value), ""]
        else:
            arguments, result = signature(value)
            lines += [f"def {name}({arguments}) -> {result}: ...", ""]
    text = "\n".join(lines)
    compile(text, out, "exec")
    with open(out, "w") as file:
        file.write(text)


if __name__ == "__main__":
    main(sys.argv[1])
