"""Compiles problem structs in C++ at run time, with the compiler of the system."""

from __future__ import annotations

import hashlib
import os
import re
import shlex
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Sequence

from . import _slalom

INCLUDE = Path(__file__).parent / "include"
_COMPILERS = ("c++", "g++", "clang++")

_END = """
#include <slalom/python/compiled_problem.hpp>
static std::vector<slalom::python::Parameter> slalom_parameters([[maybe_unused]] {name}& p) {{
  return {{{parameters}}};
}}
SLALOM_COMPILED_PROBLEM({name}, slalom_parameters)
"""


class CompileError(RuntimeError):
    """The C++ compiler rejects a problem, or there is none. The message has the compiler's words."""


def compile(source: str | os.PathLike[str] | _slalom.AnyProblem, problem: str | None = None, *,
            flags: Sequence[str] = (), gpu: int | Sequence[int] = (), derivatives: bool = False,
            **parameters: Any) -> _slalom.CompiledProblem:
    """A problem struct in C++ (docs/writing-a-problem.md) as a problem in Python, at the speed of C++.

    The compiler is $CXX, or the first one found of c++, g++ and clang++: g++ 12 or clang 14, or later. The result is
    kept in $XDG_CACHE_HOME/slalom (default: ~/.cache/slalom) and is compiled again only if the source, a header that it
    includes, the compiler's flags or Slalom have changed.
    """
    if isinstance(source, _slalom.AnyProblem):
        from .gpu import source_of

        source, problem, values = source_of(source)
        parameters = {**values, **parameters}
    text = source if isinstance(source, str) and "{" in source else Path(source).read_text()
    name, members = _problem_in(_without_comments(text), problem)
    return compile_members(source, name, parameters, [*flags, *["-DSLALOM_DERIVATIVES"] * derivatives], gpu, members)


def compile_members(source: str | os.PathLike[str], problem: str, values: dict[str, Any], flags: Sequence[str] = (),
                    gpu: int | Sequence[int] = (), members: Sequence[str] = ()) -> _slalom.CompiledProblem:
    """The problem struct of a source with its `members`, by default those that `values` sets."""
    listed = ", ".join(f'slalom::python::parameter_of("{each}", p.{each})' for each in members or values)
    end = _END.format(name=problem, parameters=listed)
    made = _slalom.CompiledProblem(str(_library(_text_of(source), problem, end, [*flags], [gpu] if isinstance(gpu, int) else [*gpu])))
    for key, value in values.items():
        setattr(made, key, value)
    return made


def _text_of(source: str | os.PathLike[str]) -> str:
    if isinstance(source, str) and "{" in source:
        return f'#include <slalom/slalom.hpp>\n#line 1 "<source>"\n{source}'
    return f'#include <slalom/slalom.hpp>\n#include "{Path(source).resolve(strict=True)}"'


def _library(text: str, problem: str, end: str, flags: list[str], architectures: list[int]) -> Path:
    """The shared library of a source text: that of the cache, or a new one."""
    compiler = shlex.split(os.environ.get("CXX", "")) or [name for name in _COMPILERS if shutil.which(name)][:1]
    if not compiler or not shutil.which(compiler[0]):
        raise CompileError(f"no C++ compiler found ({compiler[0] if compiler else ', '.join(_COMPILERS)}): install one "
                           "(Debian: g++), or set CXX")
    sources = [_slalom.__file__]
    if architectures:
        from . import gpu

        flags, sources = [*flags, "-DSLALOM_GPU", f"-I{gpu.FOLDER}"], [*sources, str(gpu.FOLDER / "session.cpp"), "-ldl"]
    command = [*compiler, "-std=c++20", "-O2", "-Wfatal-errors", "-fPIC", "-fvisibility=hidden", f"-I{INCLUDE}",
               f"-DSLALOM_ONLY_TARGET={_slalom.instruction_set()}", *flags]
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "slalom"
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as name:
        folder = Path(name)
        header, unit, result = folder / "problem.hpp", folder / "problem.cpp", folder / "problem.so"
        header.write_text("#pragma once\n" + text)
        unit.write_text(f'#include "problem.hpp"\n{end}')
        preprocessed = run([*command, "-E", "-P", str(unit)])
        key = hashlib.sha256("\0".join([*command, *sources, *map(str, architectures), preprocessed]).encode()).hexdigest()[:32]
        library = cache / f"{key}.so"
        if not library.exists():
            if architectures:
                images = gpu.compile_kernels(header, problem, architectures, compiler, flags)
                unit.write_text(f'#include "{images}"\n{end}')
            run([*command, "-shared", str(unit), *sources, "-o", str(result)])
            result.replace(library)
    return library


def run(command: Sequence[str]) -> str:
    """Runs a compiler and returns what it prints. Raises CompileError with its words if it fails."""
    done = subprocess.run(command, text=True, capture_output=True)
    if done.returncode:
        raise CompileError(f"{Path(command[0]).name} rejects the problem:\n{done.stderr}")
    return done.stdout


def _without_comments(text: str) -> str:
    return re.sub(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\])*")', lambda found: found[1] or " ", text, flags=re.S)


def _problem_in(text: str, wanted: str | None) -> tuple[str, list[str]]:
    """The name of the problem struct of a source without comments, and the names of its parameters."""
    bodies = {found[1]: _outside_braces(text, found.end()) for found in re.finditer(r"\bstruct\s+(\w+)[^;{}()]*\{", text)}
    known = [name for name, body in bodies.items() if re.search(r"\bconstexpr\s+int\s+inputs\b", body)]
    name = wanted.split("::")[-1] if wanted else known[0] if len(known) == 1 else None
    if name not in known:
        raise ValueError("compile: " + (f"problem: {wanted!r}: the source has no such struct" if wanted else
                         f"problem: must be one of {', '.join(known)}" if known else
                         "the source has no problem: a struct with `static constexpr int inputs`"))
    members = []
    for statement in bodies[name or ""].split(";"):
        declared = re.match(r"\s*(?:double|(?:std::)?array<double,[^<>]*>|(?:slalom::)?Mlp<[^<>]*>|(?:slalom::)?(?:maps::)?"
                            r"Field)\s+(.*)", statement, re.S)
        for part in re.split(r",(?![^<]*>)", declared[1]) if declared else ():
            member = re.fullmatch(r"\s*(\w+)\s*(?:[={].*)?", part, re.S)
            members += [member[1]] if member else []
    return wanted or known[0], members


def _outside_braces(text: str, start: int) -> str:
    """The text of a struct whose body begins at `start`, without what stands in inner braces or parentheses. A function
    ends with a semicolon."""
    kept, depth, is_function = "", 0, False
    for character in text[start:]:
        if character in "{(" and depth == 0:
            is_function = character == "{" and re.search(r"(\(|const|noexcept)\s*$", kept) is not None
            kept += character
        elif depth == 0 and character not in ")}":
            kept += character
        depth += (character in "{(") - (character in "})")
        if depth < 0:
            break
        if depth == 0 and character == "}" and is_function:
            kept += ";"
    return kept
