"""Checks that each program and shared library of an installation is hardened as SECURITY.md says.

  hardening_test.py PREFIX
"""
import re
import subprocess
import sys
from pathlib import Path


def readelf(option, file):
    return subprocess.run(["readelf", "-W", option, file], capture_output=True, text=True, check=True).stdout


def faults(file):
    """The faults of a program or shared library."""
    segments, dynamic, symbols = (readelf(option, file) for option in ("-l", "-d", "--dyn-syms"))
    stack = re.search(r"GNU_STACK.* (R\S*) +0x", segments)
    if not stack or "E" in stack[1]:
        yield "the stack is executable"
    if "GNU_RELRO" not in segments:
        yield "relocations stay writable (no -z relro)"
    if not re.search(r"BIND_NOW|FLAGS_1.*\bNOW\b", dynamic):
        yield "symbols are bound late (no -z now)"
    if "__stack_chk_fail" not in symbols:
        yield "no function checks its stack (no -fstack-protector-strong)"
    if not re.search(r"__\w+_chk\b", symbols.replace("__stack_chk_fail", "")):
        yield "no call checks its buffer (no _FORTIFY_SOURCE)"
    for path in re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", dynamic):
        for part in path.split(":"):
            if not part.startswith(("/", "$ORIGIN")):
                yield f"libraries are searched in '{part}', relative to the current directory: {path}"


def main():
    prefix = Path(sys.argv[1])
    files = [file for file in sorted(prefix.rglob("*")) if file.is_file() and not file.is_symlink()]
    binaries = [file for file in files if file.open("rb").read(18)[:4] == b"\x7fELF" and file.suffix != ".o"]
    if not any(file.name == "slalom" for file in binaries):
        sys.exit(f"{prefix} holds no program slalom")
    found = [f"{file}: {fault}" for file in binaries for fault in faults(file)]
    print(f"{len(binaries)} programs and libraries checked")
    notices = prefix / "share/doc/slalom/page-licenses.txt"
    if "uPlot" not in notices.read_text() or "fflate" not in notices.read_text():
        found.append(f"{notices} does not name the libraries of the page")
    sys.exit("\n".join(found) or 0)


if __name__ == "__main__":
    main()
