#!/usr/bin/env python3
"""Copies the pages and pictures of the repository to a folder for MkDocs: README.md becomes the first page, with the
introduction and the demonstration in the browser if there are; links to headers lead to the reference, and those to notebooks to their pages.

usage: pages.py TO SITE
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

INTRODUCTION = """<iframe class="demo" src="introduction.html" title="Two methods before a parked car" loading="lazy"></iframe>

"""
DEMO = """<iframe class="demo" src="demo/index.html" title="A robot among discs, in the live view" loading="lazy"></iframe>

`svg_mppi` drives a robot among discs, and your browser solves each step. Drag a disc or the robot, also while the drive is
paused: the plan follows. Then choose `mppi`. <a href="demo/index.html">The demonstration with charts and options</a>
"""


def page(path, reference, site):
    """The text of a page. Links to what the site does not have become plain text."""
    up = "../" * (len(path.parts) - 1)

    def link(match):
        mark, words, target = match.groups()
        file, _, anchor = target.partition("#")
        if mark or not file or re.match(r"\w+:", file):
            return match[0]
        at = (path.parent / file).resolve().relative_to(Path.cwd())
        if at == Path("README.md"):
            return f"[{words}]({up}index.md{'#' * bool(anchor)}{anchor})"
        if at.suffix == ".md":
            return match[0]
        if at.suffix == ".ipynb" and (site / "notebooks" / f"{at.stem}.html").exists():
            return f'<a href="{up}notebooks/{at.stem}.html">{words}</a>'
        if at in reference:
            return f'<a href="{up}reference/{reference[at]}">{words.replace("`", "")}</a>'
        return words

    fenced = re.split(r"(^```.*?^```$)", path.read_text(), flags=re.S | re.M)
    fenced[::2] = [re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", link, part) for part in fenced[::2]]
    text = "".join(fenced)
    shown = INTRODUCTION * (site / "introduction.html").exists() + DEMO * (site / "demo").exists()
    if path == Path("README.md") and shown:
        text = re.sub(r"^!\[.*\)$", lambda _: shown, text, count=1, flags=re.M)
    return text


def main(to, site):
    reference = {}
    for file in (site / "reference").glob("*_8hpp.html"):
        title = re.search(r"<title>Slalom: (\S+) File Reference", file.read_text())
        reference[Path("include", title[1])] = file.name
    for file in (site / "notebooks").glob("*.html"):
        file.write_text(re.sub(r'href="\.\./\.\./([^"]+)\.md', r'href="../\1.html', file.read_text()))
    names = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split()
    for path in map(Path, names):
        if path.suffix not in (".md", ".png", ".webp", ".webm") and path.name not in ("site.css", "site.js"):
            continue
        target = to / ("index.md" if path == Path("README.md") else path)
        target.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            target.write_text(page(path, reference, site))
        else:
            shutil.copy(path, target)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
