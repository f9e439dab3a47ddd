"""Follows docs/getting-started.md in an empty folder, as it stands: getting_started_test.py ROOT PREFIX FOLDER

The program is compiled with optimisation. Without the build type in its CMakeLists.txt, CMake and the compiler warn.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

root, prefix, folder = (Path(each).resolve() for each in sys.argv[1:])
sys.path.insert(0, str(root / "tests/docs"))
from check_docs import blocks  # noqa: E402


def run(commands, where):
    done = subprocess.run(["bash", "-ec", commands], cwd=where, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={**os.environ, "HOME": str(folder)})
    print(done.stdout)
    assert done.returncode == 0, commands
    return done.stdout


page = root / "docs/getting-started.md"
project, program = blocks(page, "cmake")[0][1], blocks(page, "cpp")[0][1]
commands = next(text for _, text in blocks(page, "sh") if "build/my_robot" in text)
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
(folder / ".local").symlink_to(prefix)  # the page installs to ~/.local


def robot(name, cmake):
    where = folder / name
    where.mkdir()
    (where / "CMakeLists.txt").write_text(cmake)
    (where / "main.cpp").write_text(program)
    return where


printed = run(commands, robot("page", project))
stopped = re.search(r"the cart stopped at ([\d.]+) m", printed)
assert stopped and abs(float(stopped[1]) - 1) < 0.1
assert "arning" not in printed

without = re.sub(r"if\(NOT CMAKE_BUILD_TYPE\).*?endif\(\)\n", "", project, flags=re.S)
assert without != project
where = robot("without", without)
assert "slalom: this project sets no build type" in run("cmake -B build -DCMAKE_PREFIX_PATH=~/.local", where)
warning = "slower without optimisation: use -O2"
header = f"${{CXX:-c++}} -std=c++20 -fsyntax-only -I{prefix}/include"
with (where / "main.cpp").open("a") as file:
    file.write("\n#ifndef OPTIMISED\n#define OPTIMISED false\n#endif\nstatic_assert(slalom::Plan<Cart>::optimised == OPTIMISED);\n")
assert warning in run(f"{header} main.cpp", where)
assert warning not in run(f"{header} -DSLALOM_ALLOW_UNOPTIMISED main.cpp; {header} -Og -DOPTIMISED=true main.cpp", where)
