"""Finds the named numbers of planner, vehicle models, navigation and tracking in their sources."""

import re
from collections import namedtuple
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = [f"{top}/{folder}" for folder in ("vehicle/planner", "vehicle/model", "navigation", "tracking")
           for top in ("include/slalom", "src")]
# `struct` is that of the numbers of a room, which begins with their scale, or empty; `value` is source text.
Number = namedtuple("Number", "path line struct kind name value comment")

CONSTANT = re.compile(r"^[ \t]*(?:static |inline )*constexpr (double|float|int|std::size_t|std::array<.*?>) ([^;(]*?[={][^;]*);",
                      re.M | re.S)
FIELD = re.compile(r"^  (double|int) (\w+ = [^;]*);", re.M)
STRUCT = re.compile(r"^struct (\w+) \{\n(  \w+Scale \w+;\n.*?)^\};", re.M | re.S)


def declarators(text):
    """Splits `a = 1, b = {2, 3}` at the commas outside of brackets, into (name, value)."""
    parts, depth = [""], 0
    for each in text:
        depth += (each in "({[") - (each in ")}]")
        if each == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += each
    for part in parts:
        name, value = re.match(r"\s*(\w+)(?:\[\w*\])?\s*(.*)", part, re.S).groups()
        yield name, " ".join(value.lstrip("= ").split())


def comment_of(text, begin, end):
    """The comment behind a declaration, on its last line and those that follow, or else that above it."""
    behind = re.match(r"[ \t]*//[/<]*(.*(?:\n[ \t]+//[/<]+ .*)*)", text[end:])
    above = re.search(r"((?:^[ \t]*//.*\n)+)$", text[:begin], re.M)
    found = behind[1] if behind else above[1] if above else ""
    return " ".join(re.sub(r"\n?[ \t]*//[/<]*", " ", found).split())


def numbers_of(path):
    """The numbers of a file: those whose value has a digit and names none of the others. A problem's number of inputs is
    part of its interface."""
    text = (ROOT / path).read_text()
    code = re.sub(r"//[^\n]*", lambda found: " " * len(found[0]), text)
    declared = [("", found, 0) for found in CONSTANT.finditer(code)]
    for struct in STRUCT.finditer(code):
        declared += [(struct[1], found, struct.start(2)) for found in FIELD.finditer(struct[2])]
    found_all = []
    for struct, found, start in declared:
        line = code.count("\n", 0, start + found.start(1)) + 1
        comment = comment_of(text, start + found.start(), start + found.end())
        found_all += [Number(path, line, struct, found[1], name, value, comment)
                      for name, value in declarators(found[2]) if name not in ("inputs", "input_names")]
    names = {number.name for number in found_all}
    return [number for number in found_all if re.search(r"(?<!\w)\.?\d", number.value)
            and not names & set(re.findall(r"[a-z]\w*", number.value))]


def robot_numbers():
    return [number for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.?pp"))
            for number in numbers_of(path.relative_to(ROOT))]
