"""Checks the documentation: its links resolve, its excerpts stand in their files, its code
compiles and runs, its commands and their options exist. The stage first-change of script/check-all applies its patches.

usage: check_docs.py links ROOT | cpp ROOT COMPILER... | python ROOT | shell ROOT PROGRAM | site FOLDER
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
from pathlib import Path

FENCED = re.compile(r"^```([^\n]*)\n(.*?)^```[^\n]*$", re.S | re.M)
EXCERPT = re.compile(r"\]\(([^)]+)\):\n\n```c\+\+\n(.*?)\n```", re.S)
OPTIONAL = ("gymnasium", "matplotlib", "mujoco", "torch")
LINK = re.compile(r"(?<!\\)\[[^\]]*\]\(([^)\s]+)[^)]*\)")


def pages(root):
    return [root / "README.md", root / "CONTRIBUTING.md", root / "CHANGELOG.md", root / "courses" / "README.md",
            *sorted((root / "docs").rglob("*.md")), *sorted((root / "examples" / "notebooks").glob("*.ipynb"))]


def markdown(path):
    """The text of a page. The cells of a notebook become paragraphs and fenced blocks of Python."""
    text = path.read_text()
    if path.suffix != ".ipynb":
        return text
    return "\n\n".join(f"```python\n{source}\n```" if kind == "code" else source
                       for kind, source in ((c["cell_type"], "".join(c["source"])) for c in json.loads(text)["cells"]))


def blocks(path, language):
    """[(line, text)] of the fenced code blocks in a language."""
    text = markdown(path)
    return [(text.count("\n", 0, found.start()) + 1, found[2][:-1]) for found in FENCED.finditer(text)
            if found[1].strip() == language]


def outside_blocks(path):
    return FENCED.sub("", markdown(path))


def anchors(path):
    """The anchors that code hosts generate for the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", outside_blocks(path), re.M)
    return {re.sub(r"[^\w\- ]", "", h.lower()).strip().replace(" ", "-") for h in headings}


def check_links(root):
    errors = []
    for page in pages(root):
        for target in LINK.findall(outside_blocks(page)):
            if re.match(r"\w+:", target):
                continue
            file, _, anchor = target.partition("#")
            path = page.parent / file if file else page
            if not path.exists():
                errors.append(f"{page}: {target}: no such file")
            elif anchor and path.suffix == ".md" and anchor not in anchors(path):
                errors.append(f"{page}: {target}: no such heading")
        for target, excerpt in EXCERPT.findall(markdown(page)):
            whole, part = (re.sub(r"^ +", "", t, flags=re.M) for t in ((page.parent / target).read_text(), excerpt))
            if part not in whole:
                errors.append(f"{page}: the code after the link to {target} is not in that file")
    return errors


def translation_unit(text, name, before):
    """The includes of a code block, and the rest: definitions in a namespace, statements in a function. The block uses
    the definitions of those before it."""
    includes, outside, inside, end = [], [], [], None
    for line in text.split("\n"):
        if line.startswith("#"):
            includes.append(line)
        elif end is not None or re.match(r"(struct|class|template|using|inline|enum|constexpr|void|int main) ?", line):
            if end is None:
                end = "};" if re.match(r"(struct|class|enum)", line) else "}"
                end = None if re.search(r"[;}]$", line) and line.count("{") == line.count("}") else end
            elif line == end:
                end = None
            outside.append(line)
        else:
            inside.append(line)
    return "\n".join(includes), "\n".join(
        [f"namespace {name} {{", *(f"using namespace {other};" for other in before), *outside, "void statements() {", *inside, "}", "}"])


def check_cpp(root, *compiler):
    errors = []
    flags = ["-std=c++20", "-O1", f"-I{root}/include"]
    with tempfile.TemporaryDirectory() as folder:
        preamble = Path(shutil.copy(Path(__file__).parent / "preamble.hpp", folder))
        subprocess.run([*compiler, *flags, "-x", "c++-header", preamble, "-o", f"{preamble}.gch"], check=True)
        for page in pages(root):
            found = blocks(page, "cpp")
            if not found:
                continue
            names = [f"block_{line}" for line, _ in found]
            parts = [translation_unit(text, names[i], names[:i]) for i, (_, text) in enumerate(found)]
            file = Path(folder) / (page.stem + ".cpp")
            file.write_text("\n".join([*(p[0] for p in parts), *(p[1] for p in parts)]))
            made = subprocess.run([*compiler, *flags, "-include", preamble, "-fsyntax-only", file], capture_output=True, text=True)
            print(f"{page.relative_to(root)}: {len(found)} blocks of C++")
            if made.returncode:
                errors.append(f"{page}: does not compile\n{made.stderr[:3000]}")
    return errors


def check_python(root):
    """The blocks run, one after the other for each page or notebook, in a folder for what they write."""
    errors = []
    os.environ["MPLBACKEND"] = "agg"
    for page in pages(root):
        found = blocks(page, "python")
        names, missing = {}, ""
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            for line, text in found:
                try:
                    exec(compile(text, f"{page}:{line}", "exec"), names)
                except Exception as error:
                    if isinstance(error, ModuleNotFoundError) and error.name.split(".")[0] in OPTIONAL:
                        missing = error.name.split(".")[0]
                    if missing and isinstance(error, (ModuleNotFoundError, NameError)):  # or what another block would define
                        print(f"{page.relative_to(root)}:{line}: not run, since {missing} is missing")
                    else:
                        errors.append(f"{page}:{line}: {type(error).__name__}: {error}")
            os.chdir(root)
        if found:
            print(f"{page.relative_to(root)}: {len(found)} blocks of Python")
    return errors


def check_shell(root, program):
    """Commands of the program exist and have the options that the page gives them; scripts exist in the tree."""
    errors, help_of = [], {}
    program = program if os.path.exists(program) else None
    for page in pages(root):
        for line, text in blocks(page, "sh"):
            if subprocess.run(["bash", "-n"], input=text, text=True, capture_output=True).returncode:
                errors.append(f"{page}:{line}: bash cannot parse this block")
            for command in text.replace("\\\n", " ").split("\n"):
                command = command.split(" #")[0]
                for path in re.findall(r"(?<![\w/.])((?:script|examples|adapters)/[\w./-]+)", command):
                    if not (root / path).exists():
                        errors.append(f"{page}:{line}: no such file: {path}")
                match = re.search(r"(?:^|\s|bin/)slalom (\w[\w-]*)(.*)", command)
                if not match or program is None:
                    continue
                word, rest = match.groups()
                if word not in help_of:
                    help_of[word] = subprocess.run([program, word, "--help"], capture_output=True, text=True)
                if help_of[word].returncode:
                    errors.append(f"{page}:{line}: no such command: `slalom {word}`")
                for option in re.findall(r"(?<!\w)(--[a-z][a-z-]*)", rest):
                    if option not in help_of[word].stdout:
                        errors.append(f"{page}:{line}: `slalom {word}` has no option {option}")
    return errors


def check_site(folder):
    """The local links of the generated pages."""
    errors, seen = [], 0
    files = {str(p): p for p in folder.rglob("*")}
    ids = {}
    for page in sorted(p for p in files.values() if p.suffix == ".html"):
        text = page.read_text(errors="replace")
        for target in re.findall(r'(?:href|src)="([^"]+)"', text):
            # Doxygen writes the last two also where it shows no nested classes or concepts.
            if re.match(r"(\w+:|//|\$|#nested-classes|#concepts)", target):
                continue
            seen += 1
            file, _, anchor = urllib.parse.unquote(target).partition("#")
            file = os.path.normpath(page.parent / file) if file else str(page)
            if file not in files and file != str(folder):
                errors.append(f"{page.relative_to(folder)}: {target}: no such file")
            elif anchor and file.endswith(".html"):
                if file not in ids:
                    ids[file] = set(re.findall(r'(?:id|name)="([^"]+)"', files[file].read_text(errors="replace")))
                if anchor not in ids[file]:
                    errors.append(f"{page.relative_to(folder)}: {target}: no such anchor")
    print(f"{seen} links on {sum(p.suffix == '.html' for p in files.values())} pages")
    return sorted(set(errors))


CHECKS = {"links": check_links, "cpp": check_cpp, "python": check_python, "shell": check_shell, "site": check_site}


def main(what, root, *rest):
    errors = CHECKS[what](Path(root).resolve(), *rest)
    print("\n".join(errors) if errors else f"{what}: no errors")
    return bool(errors)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
