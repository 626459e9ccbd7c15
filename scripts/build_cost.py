#!/usr/bin/python3
"""What building costs: lines a compiler reads and seconds of processor time, per room and source.

    scripts/build_cost.py                  lines of every source, against the budget; exit status 1 beyond it
    scripts/build_cost.py --sources 20     and the sources with most of them
    scripts/build_cost.py --build DIR      and the lines read in a build folder, whose groups of sources are compiled as
                                           one and read a header once, against the budget for these
    scripts/build_cost.py --cpu BUILD_DIR  compiles everything of a build folder again, without a compiler cache, and
                                           tells the processor time of each room (minutes)

Lines are those of code (no comments, no blank lines) of a source with all headers it includes, each once, but those of
the standard library and the operating system: everybody pays these alike, and precompiled headers pay for them. Headers
of others are counted by the preprocessor, ours by following their includes.
"""

import argparse
import json
import os
import re
import resource
import shlex
import subprocess
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "src" / "stator"
# Over all sources of src/stator, for one, and over all that a build compiles at a time. These are limits to be lowered,
# not to be filled.
MOST_LINES = 4_000_000
MOST_LINES_OF_A_SOURCE = 20_000
MOST_LINES_OF_A_BUILD = 950_000
# Headers of others that are longer than that alone: whoever includes one is no finding.
LONG = ("boost/", "CLI/", "nlohmann/", "toml++/")
OTHERS = ("fmt/", "spdlog/", "pugixml", "gtest/", "gmock/", "benchmark/", "valijson/", *LONG)

INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\\n])*")', re.DOTALL)


def code_lines(text):
    text = COMMENT.sub(lambda match: match.group(1) or "", text)
    return sum(1 for line in text.split("\n") if line.strip())


@cache
def own(path):
    """(lines of the file itself, headers of ours, headers of others)."""
    text = path.read_text()
    ours, others = [], []
    for quoted, angled in INCLUDE.findall(text):
        if quoted:
            found = ROOT / "src" / quoted
            if found.is_file():
                ours.append(found)
        elif angled.startswith(OTHERS):
            others.append(angled)
    return code_lines(text), tuple(ours), tuple(others)


@cache
def lines_of_others(headers):
    """Lines of these headers together, without the standard library and the system."""
    program = "".join(f"#include <{header}>\n" for header in headers)
    done = subprocess.run(
        ["g++", "-std=c++20", "-E", "-x", "c++", "-DFMT_SHARED", "-"],
        input=program,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        sys.exit(f"build_cost: cannot preprocess {', '.join(headers)}: {done.stderr[:400]}")
    counted, lines = False, 0
    for line in done.stdout.splitlines():
        if line.startswith("# "):
            place = line.split('"')[1]
            part = place.split("/usr/include/")[-1]
            counted = part.startswith(OTHERS) and "/c++/" not in place
        elif counted and line.strip():
            lines += 1
    return lines


def measure(*sources):
    """(lines, whether a header is among them that is long alone) of sources that are compiled as one."""
    seen, stack, total, others = set(), list(sources), 0, set()
    while stack:
        path = stack.pop()
        if path in seen:
            continue
        seen.add(path)
        lines, ours, foreign = own(path)
        total += lines
        others.update(foreign)
        stack.extend(ours)
    if others:
        total += lines_of_others(tuple(sorted(others)))
    return total, any(header.startswith(LONG) for header in others)


def tell_lines(count):
    rooms, measured, findings = defaultdict(lambda: [0, 0, 0]), [], []
    for source in sorted(SOURCES.rglob("*.cpp")):
        lines, long = measure(source)
        name = source.relative_to(SOURCES)
        room = rooms[name.parts[0]]
        room[0] += 1
        room[1] += code_lines(source.read_text())
        room[2] += lines
        measured.append((lines, name))
        if lines > MOST_LINES_OF_A_SOURCE and not long:
            findings.append(f"{name}: {lines} lines, more than {MOST_LINES_OF_A_SOURCE}; include less")
    print(f"{'room':12} {'sources':>8} {'own lines':>10} {'lines read':>11}")
    for room, (sources, written, lines) in sorted(rooms.items(), key=lambda item: -item[1][2]):
        print(f"{room:12} {sources:8} {written:10} {lines:11}")
    total = sum(room[2] for room in rooms.values())
    print(f"{'all':12} {len(measured):8} {sum(room[1] for room in rooms.values()):10} {total:11}")
    for lines, name in sorted(measured, reverse=True)[:count]:
        print(f"{lines:8} {name}")
    if total > MOST_LINES:
        findings.append(f"all sources together: {total} lines, more than {MOST_LINES}; include less")
    for finding in findings:
        print(f"build_cost: {finding}", file=sys.stderr)
    return 1 if findings else 0


def tell_groups(build_dir):
    """Lines read by the commands of a build folder that compile sources of src/stator."""
    database = build_dir / "compile_commands.json"
    if not database.exists():
        sys.exit(f"build_cost: {database} is missing; run: cmake --preset release")
    total, commands, members = 0, 0, 0
    for entry in json.loads(database.read_text()):
        file = Path(entry["directory"], entry["file"])
        named = re.findall(r'#include "([^"]+\.cpp)"', file.read_text()) if "Unity" in file.parts else [file]
        sources = [source for source in map(Path, named) if source.is_relative_to(SOURCES)]
        if sources:
            total, commands, members = total + measure(*sources)[0], commands + 1, members + len(sources)
    print(f"in {build_dir}: {members} sources in {commands} commands, {total} lines read")
    if total > MOST_LINES_OF_A_BUILD:
        print(f"build_cost: that is more than {MOST_LINES_OF_A_BUILD} lines; include less", file=sys.stderr)
        return 1
    return 0


def room_of(command, build_dir):
    target = re.search(r"CMakeFiles/([\w-]+)\.dir", command)
    return target.group(1) if target else str(build_dir)


def tell_cpu(build_dir):
    commands = subprocess.run(
        ["ninja", "-C", str(build_dir), "-t", "compdb"], capture_output=True, text=True, check=True
    ).stdout
    seconds = defaultdict(float)
    for entry in json.loads(commands):
        command = entry["command"]
        if " -c " not in command or entry["file"].endswith(".c"):
            continue
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [*shlex.split(command)],
            cwd=entry["directory"],
            check=True,
            env={**os.environ, "CCACHE_DISABLE": "1"},
            stdout=subprocess.DEVNULL,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds[room_of(command, build_dir)] += after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    for target, time in sorted(seconds.items(), key=lambda item: -item[1]):
        print(f"{target:32} {time:8.1f} s")
    tests = sum(time for target, time in seconds.items() if target.startswith("test_"))
    print(f"{'tests':32} {tests:8.1f} s")
    print(f"{'all':32} {sum(seconds.values()):8.1f} s")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sources", type=int, default=0, metavar="N", help="the N sources with most lines")
    parser.add_argument("--build", type=Path, metavar="DIR", help="lines read in a build folder")
    parser.add_argument("--cpu", type=Path, metavar="BUILD_DIR", help="processor time of a build folder's commands")
    options = parser.parse_args()
    if options.cpu:
        return tell_cpu(options.cpu)
    status = tell_lines(options.sources)
    return max(status, tell_groups(options.build.resolve())) if options.build else status


if __name__ == "__main__":
    sys.exit(main())
