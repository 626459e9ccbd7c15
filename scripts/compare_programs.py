#!/usr/bin/env python3
"""Tells what a user sees otherwise with one "stator" than with another.

  scripts/compare_programs.py OLD NEW [--count 200] [--seed 1] [--only PART] [--keep DIR] [--jobs N]

For changes after which nothing may look different: OLD is the program before, NEW the one after. PART is one of

  texts       lists, descriptions, SII, ESI and EDS files, reference and schema of rack files, help, refused commands
  refusals    sentences about wrong rack files and scenarios: tests/data/refused_racks and refused_scenarios, and some
              thousands that are drawn from the schema
  recordings  --count sessions with OLD, drawn by --seed: racks of all products with faults, power cycles, masters with
              SYNC0, downloads, boot loaders; both programs replay each and write all its signals every 100 us

--only may be given several times. Each difference is printed with the command that shows it; --keep DIR keeps drawn
rack files and recordings that show one. At the end come counts of what was compared. Exit status 1 if anything differs.
docs/architecture.md, "Changing the house", says when to run it.
"""

import argparse
import os
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests" / "rigs")]

from comparison import recordings, refusals, texts  # noqa: E402
from comparison.outcome import Report  # noqa: E402

PARTS = {"texts": texts.compare, "refusals": refusals.compare, "recordings": recordings.compare}


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", action="append", choices=PARTS)
    parser.add_argument("--keep")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    return parser.parse_args(arguments)


def main(arguments=None):
    options = options_of(arguments)
    programs = [os.path.abspath(program) for program in (options.old, options.new)]
    for program in programs:
        if not os.access(program, os.X_OK):
            print(f"{program}: no such program", file=sys.stderr)
            return 2
    lines = []
    differences = 0
    for part in options.only or PARTS:
        report = Report(part)
        begin = time.monotonic()
        PARTS[part](*programs, options, report)
        lines.append(f"{report.line()}; {time.monotonic() - begin:.0f} s")
        differences += report.differences
    print(*lines, sep="\n")
    print("nothing differs" if not differences else f"{differences} differences")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
