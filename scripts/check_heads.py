#!/usr/bin/env python3
"""Checks that every source file in C and C++ says at its head what it is for.

Rules:
  head  the first thing in a file after #pragma once, includes and other lines of the preprocessor, the
        beginnings of namespaces, using lines and forward declarations is a comment: of the file, or
        of the type, function or constant that is declared first

A source file with a header of the same name beside it needs no head of its own: that header says it.

Prints `file: head: what is wrong; remedy` for each file without a head; exit status 1 if there is one.
"""

import argparse
import re
import sys
from pathlib import Path

FOLDERS = ("src", "tests", "fuzz", "benchmarks", "examples", "clients")
HEADER_OF = {".cpp": ".hpp", ".c": ".h"}
SUFFIXES = (".hpp", ".h", *HEADER_OF)

# What may stand above a head, each with the rest of its line.
BEFORE = re.compile(
    r"\s+"
    r"|\#(?:\\\n|[^\n])*"
    r"|(?:inline\s+)?namespace\b[^{;]*[{;][^\n]*"
    r"|using\b[^;]*;[^\n]*"
    r'|extern\s+"C"\s*\{[^\n]*'
    r"|(?:template\s*<[^;{]*>\s*)?(?:class|struct|union|enum(?:\s+class)?)\s+[\w:]+(?:\s*:\s*[\w:]+)?\s*;[^\n]*"
    r"|\}[^\n]*"
)
# Comments that are for tools.
FOR_TOOLS = re.compile(r"//\s*(?:NOLINT|clang-format\b|IWYU\b)[^\n]*")
COMMENT = re.compile(r"//|/\*")


def has_head(text):
    position = 0
    while found := BEFORE.match(text, position) or FOR_TOOLS.match(text, position):
        position = found.end()
    return COMMENT.match(text, position) is not None


def files_without_head(root):
    """The files below `root` that do not say what they are for, as paths from there."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            header = HEADER_OF.get(path.suffix)
            if header and path.with_suffix(header).exists():
                continue
            if not has_head(path.read_text(encoding="utf-8")):
                yield path.relative_to(root)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent, help="the project's folder"
    )
    files = list(files_without_head(parser.parse_args().root))
    for path in files:
        print(
            f"{path}: head: does not say what it is for; write a comment of one sentence above its includes",
            file=sys.stderr,
        )
    print(f"heads: {len(files)} files without one")
    return 1 if files else 0


if __name__ == "__main__":
    sys.exit(main())
