"""Controllers that solve on a GPU (docs/gpu.md)."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any, Sequence

from . import _slalom, display
from .compiler import INCLUDE, CompileError, run

FOLDER = INCLUDE / "gpu"


class DeviceError(RuntimeError):
    """No driver, no device, no code for it, too little memory, or a fault of the device."""


class _OnGpu:
    def refresh(self) -> None:
        """Copies the memory that the problem declares (`visit_memory`) to the device again, for the next solve."""
        getattr(self, "_refresh_gpu")()

    @property
    def fault(self) -> str:
        """Why the device fails; empty if it does not. Plans then repeat the last one, with the status 'degenerate'."""
        return str(getattr(self, "_gpu_fault")())


class Mppi(_OnGpu, _slalom.Mppi):
    """`mppi` on a GPU, for a problem that `slalom.compile` has compiled with `gpu`. Arguments: those of slalom.Mppi."""
    _method = "gpu.mppi"


class SvgMppi(_OnGpu, _slalom.SvgMppi):
    """`svg_mppi` on a GPU, for a problem that `slalom.compile` has compiled with `gpu`. Arguments: those of
    slalom.SvgMppi."""
    _method = "gpu.svg_mppi"


def toolkit() -> tuple[Path, Path]:
    """The folder of CUDA's toolkit, $CUDA_PATH if that is set, and that of its libraries."""
    given = os.environ.get("CUDA_PATH")
    places = [Path(given)] if given else [Path("/usr/local/cuda"), Path("/usr")]
    for place in places:
        for libraries in place / "lib64", place / "lib", place / "lib/x86_64-linux-gnu":
            if (place / "include/nvrtc.h").exists() and (libraries / "libnvrtc.so").exists():
                return place.resolve(), libraries
    raise CompileError(f"no CUDA toolkit in {', '.join(map(str, places))}: a problem for a GPU needs include/nvrtc.h and "
                       "libnvrtc.so (NVRTC; nvcc is not needed); install the toolkit, or set CUDA_PATH to its folder")


def compile_kernels(header: Path, problem: str, architectures: Sequence[int], compiler: Sequence[str],
                    flags: Sequence[str]) -> Path:
    """A source file, beside the header, that has the problem's kernels for GPUs."""
    if not (FOLDER / "compile.cpp").exists():
        raise CompileError("this build of the package has no GPU layer: build it from Slalom's sources (pip install .)")
    cuda, libraries = toolkit()
    compile_with_nvrtc, images = header.with_name("slalom_gpu_compile"), header.with_name("images.cpp")
    run([*compiler, "-std=c++20", "-O1", f"-I{cuda}/include", f"{FOLDER}/compile.cpp", f"-L{libraries}", "-lnvrtc",
         f"-Wl,-rpath,{libraries}", "-o", str(compile_with_nvrtc)])
    run([str(compile_with_nvrtc), str(images), str(header), problem, " ".join(map(str, architectures)), f"-I{FOLDER}",
         f"-I{cuda}/include/cccl", f"-I{cuda}/include", f"-I{INCLUDE}", *(f for f in flags if f[:2] in ("-I", "-D"))])
    return images


def source_of(problem: _slalom.AnyProblem) -> tuple[str | Path, str, dict[str, Any]]:
    """The struct of a problem of this package: source, name, and the parameters to set."""
    kind = type(problem).__name__
    header = INCLUDE / "slalom/problems" / f"{re.sub('(?<!^)(?=[A-Z])', '_', kind).lower()}.hpp"
    if not header.exists():
        raise ValueError(f"compile: source: slalom.{kind} has no struct in C++; must be a built-in problem, "
                         "or the text or file of a struct (docs/gpu.md#from-python)")
    return header, f"slalom::problems::{kind}", display.changed(problem)
