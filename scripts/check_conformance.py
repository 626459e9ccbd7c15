#!/usr/bin/env python3
"""Checks docs/conformance/<device>.csv against the requirements and the tests that exist.

One row per requirement, columns id,status,tests,note:
  status  done, open (to come), or for good: simplified or left-out
  tests   GoogleTest names, Suite.Name, separated by semicolons or blanks; `done` needs one
  note    what differs or why; all but `done` need it

The requirements of a device stand in tests/data/<device>/requirements.csv (column id); each has
exactly one row. Prints `file:line: what is wrong; remedy`; exit status 1 if anything is wrong.
"""

import argparse
import csv
import re
import sys
from pathlib import Path

COLUMNS = ["id", "status", "tests", "note"]
STATUSES = ("done", "simplified", "left-out", "open")
TEST_MACRO = re.compile(r"\b(?:TYPED_)?TEST(?:_F|_P)?\s*\(\s*(\w+)\s*,\s*(\w+)\s*\)")


def existing_tests(tests_folder):
    """Suite.Name of every GoogleTest case declared below `tests_folder`."""
    names = set()
    for source in sorted(tests_folder.rglob("*.cpp")):
        for suite, name in TEST_MACRO.findall(source.read_text(encoding="utf-8")):
            names.add(f"{suite}.{name}")
    return names


def check_row(row, tests):
    """What is wrong with one row, as sentences."""
    named = row["tests"].replace(";", " ").split()
    if row["status"] not in STATUSES:
        yield f"status '{row['status']}' is none of {', '.join(STATUSES)}"
    if row["status"] == "done" and not named:
        yield "status is done but no test is named; name the test that shows it"
    if row["status"] in STATUSES[1:] and not row["note"].strip():
        yield f"status is {row['status']} without a note; say what differs or why"
    for name in named:
        if name not in tests:
            yield f"there is no test {name} in tests/; correct the name or write the test"


def read_requirements(path):
    """Identifiers of all requirements; None if the file does not exist."""
    if not path.exists():
        return None
    with path.open(encoding="utf-8", newline="") as file:
        return [row["id"] for row in csv.DictReader(file, strict=True)]


def check_device(path, requirements, tests):
    """Errors of one device's file as (line, sentence)."""
    required = read_requirements(requirements)
    if required is None:
        yield 1, f"there is no tests/data/{path.stem}/{requirements.name}; list the requirements there"
    seen = {}
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file, strict=True)
        if reader.fieldnames != COLUMNS:
            yield 1, f"columns are {reader.fieldnames}, must be {','.join(COLUMNS)}"
            return
        for row in reader:
            line, identifier = reader.line_num, row["id"]
            if None in row or None in row.values():
                yield line, f"{identifier}: not four columns; put a text with commas in quotes"
                continue
            if identifier in seen:
                yield line, f"{identifier}: has a row already in line {seen[identifier]}; keep one"
            seen[identifier] = line
            if required is not None and identifier not in required:
                yield line, f"{identifier}: is no requirement in {requirements.name}; correct the id"
            for sentence in check_row(row, tests):
                yield line, f"{identifier}: {sentence}"
    for identifier in required or []:
        if identifier not in seen:
            yield 1, f"{identifier}: has no row; add one, open with a note until it is done"


def check_tree(root):
    """All errors in the tree below `root`, as text."""
    tests = existing_tests(root / "tests")
    folder = root / "docs" / "conformance"
    devices = {p.stem for p in folder.glob("*.csv")}
    devices |= {p.parent.name for p in (root / "tests" / "data").glob("*/requirements.csv")}
    for device in sorted(devices):
        path = folder / f"{device}.csv"
        shown = path.relative_to(root)
        if not path.exists():
            yield f"{shown}:1: missing; write one row per requirement of tests/data/{device}/requirements.csv"
            continue
        requirements = root / "tests" / "data" / device / "requirements.csv"
        for line, sentence in check_device(path, requirements, tests):
            yield f"{shown}:{line}: {sentence}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent, help="the project's folder"
    )
    errors = list(check_tree(parser.parse_args().root))
    for error in errors:
        print(error, file=sys.stderr)
    print(f"conformance: {len(errors)} errors")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
