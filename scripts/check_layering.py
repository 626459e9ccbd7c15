#!/usr/bin/env python3
"""Checks that the rooms of src/stator/ and their folders keep to the table in docs/architecture.md.

Rules:
  table     every room has a row in the table, and a room may use only rooms of rows below its own;
            the row of a room with folders names them from top to bottom, and no others exist
  uses      the USES list of src/stator/<room>/CMakeLists.txt names only rooms the table allows
  include   an #include "stator/<room>/..." names the own room or one of the USES list
  folder    within a room a file includes from its own folder and from lower ones; files that stand in
            the room itself are below all its folders
  face      the headers that stand in src/stator/ itself are for users of the library: they include each
            other and rooms that are installed (stator_room() without PROGRAM), and no room includes them
  internal  a folder internal/ is included from only by the files of the folder it stands in, and by
            its own
  size      no folder has more than 40 files (sources, headers, CMakeLists.txt)
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

SOURCES = Path("src") / "stator"
PREFIX = "stator"
INTERNAL = "internal"
LARGEST_FOLDER = 40

TABLE_ROW = re.compile(r"^\|\s*`(\w+)`(?::\s*([^|]*?))?\s*\|.*\|\s*([^|]*?)\s*\|\s*(yes|no)\s*\|\s*$")

FORBIDDEN_HEADERS = re.compile(
    r"^(thread|chrono|mutex|shared_mutex|condition_variable|future|semaphore|latch|barrier|stop_token"
    r"|atomic|iostream|fstream|ostream|istream|filesystem|random|ctime|time\.h|cstdio|stdio\.h"
    r"|csignal|signal\.h|unistd\.h|fcntl\.h|pthread\.h|poll\.h|errno\.h|cerrno"
    r"|(sys|net|netinet|linux|arpa)/.*)$"
)

_LIBM = "sin|cos|tan|sincos|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|fma"

FORBIDDEN_NAMES = (
    (
        re.compile(rf"\bstd::(?:{_LIBM})[fl]?\s*\("),
        "calls a libm function whose last bits differ between machines",
        "use stator/base/trigonometry.hpp, or compute the constant outside the simulation",
    ),
    (
        re.compile(rf"(?<![\w:.>])(?:{_LIBM})[fl]?\s*\("),
        "calls a libm function whose last bits differ between machines",
        "use stator/base/trigonometry.hpp, or compute the constant outside the simulation",
    ),
    (
        re.compile(
            r"\bstd::(?:chrono|thread|jthread|mutex|this_thread|async|cout|cerr|clog)\b"
            r"|\b(?:clock_gettime|gettimeofday|nanosleep|usleep)\s*\("
        ),
        "uses a clock, a thread or a stream",
        "take time as base::SimTime and report a base::Event",
    ),
    (
        re.compile(r"\bstd::(?:random_device|mt19937|rand|srand)\b|(?<![\w:.>])s?rand\s*\("),
        "takes randomness that is not seeded from the rack file",
        "use stator/base/random.hpp",
    ),
    (re.compile(r"\bthread_local\b"), "keeps state outside its objects", "make it a member of the object that owns it"),
)

IN_PROGRAM = re.compile(r"stator_room\s*\([^)]*\bPROGRAM\b")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


@dataclass(frozen=True)
class Room:
    name: str
    folders: tuple  # from top to bottom
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
            name, folders, uses, portable = match.groups()
            rooms[name] = Room(
                name,
                tuple(re.findall(r"\w+", folders or "")),
                tuple(re.findall(r"`(\w+)`", uses)),
                portable == "yes",
                number,
            )
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
        r"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'",
        re.DOTALL,
    )

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
                yield Violation(
                    table_path, room.line, "table", f"{room.name} may use {used}, which has no row; add the row"
                )
            elif order.index(used) <= order.index(room.name):
                yield Violation(
                    table_path,
                    room.line,
                    "table",
                    f"{room.name} may use {used}, which stands above it; arrows point down "
                    "only, move the wall between the two rooms",
                )


def check_uses(room, uses, path):
    for used, line in uses.items():
        if used not in room.may_use:
            yield Violation(
                path,
                line,
                "uses",
                f"{room.name} may not use {used}, only {', '.join(room.may_use) or 'none'}; "
                "pass what is needed through an interface, or move it down",
            )


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


def folder_of(parts):
    """The folder of a file by the parts of its path below the room; "": the room itself."""
    return parts[0] if len(parts) > 1 and parts[0] != INTERNAL else ""


def check_include(room, uses, rooms, path, number, quote, header):
    prefix, *parts = header.split("/")
    if prefix == PREFIX:
        owner = parts[0]
        if owner == room.name:
            yield from check_folder(room, path, number, header)
        elif owner not in rooms:
            yield Violation(
                path,
                number,
                "include",
                f'"{header}" names no room, and what stands beside the rooms is for users of the '
                f'library; write "{PREFIX}/<room>/..." with a room of the table',
            )
        elif owner not in room.may_use:
            yield Violation(
                path,
                number,
                "include",
                f"{room.name} may not use {owner}, only "
                f"{', '.join(room.may_use) or 'none'}; pass what is needed through an "
                "interface, or move it down",
            )
        elif owner not in uses:
            yield Violation(
                path,
                number,
                "include",
                f"{owner} is not in the USES list of {room.name}; add it to {SOURCES / room.name}/CMakeLists.txt",
            )
        yield from check_internal(path, number, header)
    elif prefix in rooms and parts:
        yield Violation(
            path,
            number,
            "include",
            f'"{header}" does not begin with {PREFIX}/; write "{PREFIX}/{header}", and the folder if the room has some',
        )
    elif quote == '"' and not parts:
        yield Violation(
            path,
            number,
            "include",
            f'"{header}" does not name its room; write '
            f'"{Path(path).parent.relative_to(SOURCES.parent).as_posix()}/{header}"',
        )
    elif quote == "<" and room.portable and FORBIDDEN_HEADERS.match(header):
        yield Violation(
            path,
            number,
            "portable",
            f"<{header}> ties {room.name} to an operating system, a clock or a stream; do this in link, rack or cli",
        )


def check_folder(room, path, number, header):
    """That a file includes nothing of its own room that stands above it."""
    order = [*room.folders, ""]
    own = folder_of(Path(path).relative_to(SOURCES / room.name).parts)
    used = folder_of(header.split("/")[2:])
    if own in order and used in order and order.index(used) < order.index(own):
        yield Violation(
            path,
            number,
            "folder",
            f'{own or room.name + " itself"} may not include "{header}": {used} stands above '
            f"it in the row of {room.name}; move the file down, split from it what both "
            "need, or pass it through an interface",
        )


def check_internal(path, number, header):
    """That nobody includes from the internal/ folder of another."""
    parts = header.split("/")
    if INTERNAL in parts[:-1]:
        owner = "/".join(parts[: parts.index(INTERNAL)])
        folder = Path(path).parent.relative_to(SOURCES.parent)
        if folder.name == INTERNAL:
            folder = folder.parent
        if folder.as_posix() != owner:
            yield Violation(
                path,
                number,
                "internal",
                f'"{header}" is internal to {owner}; include a header of {owner} itself, or move what is needed there',
            )


def check_folders(room, folder, table_path):
    """That the row of a room names the folders it has, and that none is too large."""
    found = set()
    root = SOURCES / room.name
    for place in (folder, *sorted(p for p in folder.rglob("*") if p.is_dir())):
        parts = place.relative_to(folder).parts
        own = [p for p in place.iterdir() if p.suffix in (".cpp", ".hpp", ".h") or p.name == "CMakeLists.txt"]
        shown = root.joinpath(*parts).as_posix()
        if len(own) > LARGEST_FOLDER:
            yield Violation(
                shown,
                1,
                "size",
                f"{len(own)} files are more than the {LARGEST_FOLDER} a folder may have; divide it by subject",
            )
        if parts and parts[-1] != INTERNAL and own:
            if len(parts) > 1:
                yield Violation(
                    shown, 1, "table", f"a folder of a folder; make it a folder of {room.name}, or call it {INTERNAL}"
                )
            elif parts[0] not in room.folders:
                yield Violation(
                    shown,
                    1,
                    "table",
                    f"the row of {room.name} in {table_path} does not name the folder "
                    f"{parts[0]}; name it above all that it includes",
                )
            found.add(parts[0])
    for name in room.folders:
        if name not in found:
            yield Violation(table_path, room.line, "table", f"{room.name} has no folder {name}; take it out of the row")


def check_face(root, rooms):
    """That the headers for users are of what is installed."""
    for header in sorted((root / SOURCES).glob("*.hpp")):
        path = str(header.relative_to(root))
        for number, line in enumerate(blank_comments(header.read_text(encoding="utf-8")).splitlines(), 1):
            include = INCLUDE.match(line)
            parts = include.group(2).split("/") if include else []
            if not parts or parts[0] != PREFIX:
                continue
            if len(parts) == 2:
                if not (root / SOURCES / parts[1]).exists():
                    yield Violation(path, number, "face", f'"{include.group(2)}" does not exist')
                continue
            lists = root / SOURCES / parts[1] / "CMakeLists.txt"
            if parts[1] not in rooms:
                yield Violation(path, number, "face", f'"{include.group(2)}" names no room of the table')
            elif lists.exists() and IN_PROGRAM.search(lists.read_text(encoding="utf-8")):
                yield Violation(
                    path,
                    number,
                    "face",
                    f"{parts[1]} is a part of the program and not installed; move what users need to a room below",
                )
            elif INTERNAL in parts:
                yield Violation(path, number, "face", f'"{include.group(2)}" is internal to its room')


def check_tree(root):
    """All violations in the tree below `root`."""
    table = root / "docs" / "architecture.md"
    table_path = str(table.relative_to(root))
    rooms = parse_table(table.read_text(encoding="utf-8")) if table.exists() else {}
    if not rooms:
        yield Violation(table_path, 1, "table", "no table of rooms found; write one row per room")
        return
    yield from check_table(rooms, table_path)
    yield from check_face(root, rooms)
    for folder in sorted(p for p in (root / SOURCES).iterdir() if p.is_dir()):
        sources = sorted(p for p in folder.rglob("*") if p.suffix in (".cpp", ".hpp", ".h"))
        room = rooms.get(folder.name)
        if room is None:
            if sources:
                yield Violation(
                    str(SOURCES / folder.name), 1, "table", f"the room has no row in {table_path}; add the row"
                )
            continue
        yield from check_folders(room, folder, table_path)
        lists = folder / "CMakeLists.txt"
        build_text = lists.read_text(encoding="utf-8") if lists.exists() else ""
        uses = parse_uses(build_text)
        if uses is None:
            if sources and "add_executable" not in build_text:
                yield Violation(
                    str(lists.relative_to(root)),
                    1,
                    "uses",
                    "no stator_room() call found; declare the room with its USES list",
                )
            uses = dict.fromkeys(room.may_use, 1)
        yield from check_uses(room, uses, str(lists.relative_to(root)))
        for source in sources:
            yield from check_source(
                room, uses, rooms, str(source.relative_to(root)), source.read_text(encoding="utf-8")
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "root", nargs="?", type=Path, default=Path(__file__).resolve().parent.parent, help="the project's folder"
    )
    violations = list(check_tree(parser.parse_args().root))
    for violation in violations:
        print(violation, file=sys.stderr)
    print(f"layering: {len(violations)} violations")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
