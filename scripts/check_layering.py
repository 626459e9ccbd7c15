#!/usr/bin/env python3
"""Checks that the rooms of src/ keep to the table in docs/architecture.md.

Rules:
  table     every room has a row in the table, and a room may use only rooms of rows below its own
  uses      the USES list of src/<room>/CMakeLists.txt names only rooms the table allows
  include   an #include "<room>/..." names the own room or one of the USES list
  portable  a portable room includes no header of the operating system, of threads, clocks or streams,
            takes no randomness that is not seeded and calls none of libm's transcendental functions,
            whose last bits differ between machines

Prints `file:line: rule: what is wrong; remedy` for each violation; exit status 1 if there is one.
"""

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

TABLE_ROW = re.compile(r"^\|\s*`(\w+)`\s*\|.*\|\s*([^|]*?)\s*\|\s*(yes|no)\s*\|\s*$")

FORBIDDEN_HEADERS = re.compile(
    r"^(thread|chrono|mutex|shared_mutex|condition_variable|future|semaphore|latch|barrier|stop_token"
    r"|atomic|iostream|fstream|ostream|istream|filesystem|random|ctime|time\.h|cstdio|stdio\.h"
    r"|csignal|signal\.h|unistd\.h|fcntl\.h|pthread\.h|poll\.h|errno\.h|cerrno"
    r"|(sys|net|netinet|linux|arpa)/.*)$")

_LIBM = "sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|fma"

FORBIDDEN_NAMES = (
    (re.compile(r"\bstd::(?:%s)[fl]?\s*\(" % _LIBM),
     "calls a libm function whose last bits differ between machines",
     "use base/trigonometry.hpp, or compute the constant outside the simulation"),
    (re.compile(r"(?<![\w:.>])(?:%s)[fl]?\s*\(" % _LIBM),
     "calls a libm function whose last bits differ between machines",
     "use base/trigonometry.hpp, or compute the constant outside the simulation"),
    (re.compile(r"\bstd::(?:chrono|thread|jthread|mutex|this_thread|async|cout|cerr|clog)\b"
                r"|\b(?:clock_gettime|gettimeofday|nanosleep|usleep)\s*\("),
     "uses a clock, a thread or a stream", "take time as base::SimTime and report a base::Event"),
    (re.compile(r"\bstd::(?:random_device|mt19937|rand|srand)\b|(?<![\w:.>])s?rand\s*\("),
     "takes randomness that is not seeded from the rack file", "use base/random.hpp"),
    (re.compile(r"\bthread_local\b"), "keeps state outside its objects",
     "make it a member of the object that owns it"),
)

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


@dataclass(frozen=True)
class Room:
    name: str
    may_use: tuple
    portable: bool
    line: int


@dataclass(frozen=True)
class Violation:
    path: str
    line: int
    rule: str
    text: str

    def __str__(self):
        return f"{self.path}:{self.line}: {self.rule}: {self.text}"


def parse_table(text):
    """The rooms of the table in docs/architecture.md, from the top of the table to its bottom."""
    rooms = {}
    for number, line in enumerate(text.splitlines(), 1):
        match = TABLE_ROW.match(line)
        if match:
            name, uses, portable = match.groups()
            names = tuple(re.findall(r"`(\w+)`", uses))
            rooms[name] = Room(name, names, portable == "yes", number)
    return rooms


def parse_uses(text):
    """Rooms of the USES list in a room's CMakeLists.txt with their lines; None without a room."""
    text = re.sub(r"#[^\n]*", "", text)
    call = re.search(r"stator_room\s*\(([^)]*)\)", text)
    if call is None:
        return None
    uses, keyword = {}, ""
    for token in re.finditer(r"\S+", call.group(1)):
        if token.group() in ("SOURCES", "APART", "ALONE", "USES", "LIBRARIES", "PRECOMPILED"):
            keyword = token.group()
        elif keyword == "USES":
            uses[token.group()] = text.count("\n", 0, call.start(1) + token.start()) + 1
    return uses


def blank_comments(text):
    """`text` with comments and the contents of string literals replaced by blanks, lines kept."""
    token = re.compile(
        r'//[^\n]*|/\*.*?\*/|R"([^(\s]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"'
        r"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'", re.DOTALL)

    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())

    # Include lines look like strings and must survive.
    lines = text.split("\n")
    kept = {i: line for i, line in enumerate(lines) if INCLUDE.match(line)}
    result = token.sub(blank, text).split("\n")
    for i, line in kept.items():
        if result[i].lstrip().startswith("#"):
            result[i] = line
    return "\n".join(result)


def check_table(rooms, table_path):
    order = list(rooms)
    for room in rooms.values():
        for used in room.may_use:
            if used not in rooms:
                yield Violation(table_path, room.line, "table",
                                f"{room.name} may use {used}, which has no row; add the row")
            elif order.index(used) <= order.index(room.name):
                yield Violation(table_path, room.line, "table",
                                f"{room.name} may use {used}, which stands above it; arrows point down "
                                "only, move the wall between the two rooms")


def check_uses(room, uses, path):
    for used, line in uses.items():
        if used not in room.may_use:
            yield Violation(path, line, "uses",
                            f"{room.name} may not use {used}, only {', '.join(room.may_use) or 'none'}; "
                            "pass what is needed through an interface, or move it down")


def check_source(room, uses, rooms, path, text):
    for number, line in enumerate(blank_comments(text).splitlines(), 1):
        include = INCLUDE.match(line)
        if include:
            yield from check_include(room, uses, rooms, path, number, *include.groups())
        elif room.portable:
            for pattern, wrong, remedy in FORBIDDEN_NAMES:
                found = pattern.search(line)
                if found:
                    name = found.group().rstrip("( ")
                    yield Violation(path, number, "portable", f"{name} {wrong}; {remedy}")


def check_include(room, uses, rooms, path, number, quote, header):
    owner = header.split("/")[0]
    if quote == '"' and "/" not in header:
        yield Violation(path, number, "include",
                        f'"{header}" does not name its room; write "{room.name}/{header}"')
    elif "/" in header and owner in rooms and owner != room.name:
        if owner not in room.may_use:
            yield Violation(path, number, "include",
                            f"{room.name} may not use {owner}, only "
                            f"{', '.join(room.may_use) or 'none'}; pass what is needed through an "
                            "interface, or move it down")
        elif owner not in uses:
            yield Violation(path, number, "include",
                            f"{owner} is not in the USES list of {room.name}; add it to "
                            f"src/{room.name}/CMakeLists.txt")
    elif quote == "<" and room.portable and FORBIDDEN_HEADERS.match(header):
        yield Violation(path, number, "portable",
                        f"<{header}> ties {room.name} to an operating system, a clock or a stream; "
                        "do this in link, rack or cli")


def check_tree(root):
    """All violations in the tree below `root`."""
    table = root / "docs" / "architecture.md"
    table_path = str(table.relative_to(root))
    rooms = parse_table(table.read_text(encoding="utf-8")) if table.exists() else {}
    if not rooms:
        yield Violation(table_path, 1, "table", "no table of rooms found; write one row per room")
        return
    yield from check_table(rooms, table_path)
    for folder in sorted(p for p in (root / "src").iterdir() if p.is_dir()):
        sources = sorted(p for p in folder.rglob("*") if p.suffix in (".cpp", ".hpp", ".h"))
        room = rooms.get(folder.name)
        if room is None:
            if sources:
                yield Violation(f"src/{folder.name}", 1, "table",
                                f"the room has no row in {table_path}; add the row")
            continue
        lists = folder / "CMakeLists.txt"
        build_text = lists.read_text(encoding="utf-8") if lists.exists() else ""
        uses = parse_uses(build_text)
        if uses is None:
            if sources and "add_executable" not in build_text:
                yield Violation(str(lists.relative_to(root)), 1, "uses",
                                "no stator_room() call found; declare the room with its USES list")
            uses = dict.fromkeys(room.may_use, 1)
        yield from check_uses(room, uses, str(lists.relative_to(root)))
        for source in sources:
            yield from check_source(room, uses, rooms, str(source.relative_to(root)),
                                    source.read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path,
                        default=Path(__file__).resolve().parent.parent, help="the project's folder")
    violations = list(check_tree(parser.parse_args().root))
    for violation in violations:
        print(violation, file=sys.stderr)
    print(f"layering: {len(violations)} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
