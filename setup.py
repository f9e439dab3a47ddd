"""Builds the Python package with CMake: pip install .

SLALOM_DRIVING=1 also builds courses, planner and simulator of cars. CMAKE_ARGS has further arguments of CMake.
"""

import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def run(self):
        build, prefix = Path(self.build_temp).resolve() / "cmake", Path(self.build_lib).resolve()
        if self.inplace:
            sys.exit("an editable install is not supported: build with CMake and set PYTHONPATH (docs/python.md)")
        driving = "ON" if os.environ.get("SLALOM_DRIVING", "0") == "1" else "OFF"
        settings = {"CMAKE_BUILD_TYPE": "Release", "PYTHON_EXECUTABLE": sys.executable, "Python_EXECUTABLE": sys.executable,
                    "SLALOM_BUILD_TOOLS": "OFF", "SLALOM_PYTHON_DIR": ".", "SLALOM_PYTHON_WHEEL": "ON",
                    **{f"SLALOM_BUILD_{layer}": driving for layer in ("NAVIGATION", "TRACKING", "VEHICLE", "SIM")}}
        try:
            import pybind11  # of the index; otherwise CMake finds that of the system
            settings["pybind11_DIR"] = pybind11.get_cmake_dir()
        except ImportError:
            pass
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        cmake = os.environ.get("CMAKE", "cmake")
        (build / "CMakeCache.txt").unlink(missing_ok=True)  # of another isolated environment, which is gone with its programs
        subprocess.run([cmake, "-S", ROOT, "-B", build, *generator, *(f"-D{k}={v}" for k, v in settings.items()),
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run([cmake, "--build", build, "--target", "slalom_python", "--parallel", jobs], check=True)
        subprocess.run([cmake, "--install", build, "--component", "python", "--prefix", prefix], check=True)


def platform_of_wheel():
    """PEP 600: a wheel that contains all libraries but those of every Linux runs where the C library is as new."""
    name, version = platform.libc_ver()
    return {"plat_name": f"manylinux_{version.replace('.', '_')}_{platform.machine()}"} if name == "glibc" else {}


setup(
    version=re.search(r"project\(slalom VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1],
    packages=[],
    py_modules=[],
    ext_modules=[Extension("slalom._slalom", sources=[])],  # built by CMake; its name makes the wheel one of this platform
    cmdclass={"build_ext": CMakeBuild},
    setup_requires=[] if shutil.which(os.environ.get("CMAKE", "cmake")) else ["cmake>=3.22", "ninja"],
    options={"bdist_wheel": platform_of_wheel()},
)
