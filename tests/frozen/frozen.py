#!/usr/bin/env python3
"""Compares a program with what is frozen in tests/data, or freezes what it says.

  tests/frozen/frozen.py PART --stator PROGRAM [--freeze] [--jobs N]

PART is one of

  refused_racks, refused_scenarios   the sentences about wrong files, in sentences.txt beside them
  recordings                         all signals of recordings, by the hashes in signals.sha256 beside them

Exit status 1 if anything differs. --freeze writes those files anew, for a change that is meant: the commit's difference
then shows what users will see. New recordings are made by tests/frozen/make_recordings.py.
"""

import argparse
import os
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests" / "rigs")]

from comparison import refusals  # noqa: E402
from comparison.outcome import in_parallel  # noqa: E402
from comparison.recordings import replay  # noqa: E402

DATA = ROOT / "tests" / "data"
PERIOD = "500us"  # between two rows of signals


def sentences(options, folder):
    """Differences as texts."""
    with tempfile.TemporaryDirectory() as place:  # where anybody can write, which decides what is said
        copy = Path(place, folder.relative_to(ROOT))
        for each in ("tests/data/refused_racks", "tests/data/refused_scenarios", "racks", "examples"):
            shutil.copytree(ROOT / each, Path(place, each))
        said = refusals.frozen_text(options.stator, copy, options.jobs)
    file = folder / "sentences.txt"
    if options.freeze:
        file.write_text(said, encoding="utf-8")
    return [
        f"cd {folder.relative_to(ROOT)} && {command}\n" + "\n".join(lines)
        for command, lines in refusals.differences_from_frozen(file.read_text(encoding="utf-8"), said)
    ]


def signals(options, folder):
    frozen = folder / "signals.sha256"
    recordings = sorted(folder.glob("*.stator"))
    differences = []
    with tempfile.TemporaryDirectory() as place:

        def replayed(recording):
            csv = Path(place, recording.stem + ".csv")
            outcome, digest = replay(options.stator, recording, csv, PERIOD)
            csv.unlink(missing_ok=True)
            return outcome, digest

        results = list(in_parallel(options.jobs, replayed, recordings))
    if options.freeze:
        frozen.write_text(
            "".join(
                f"{digest}  {recording.name}\n" for recording, (_, digest) in zip(recordings, results, strict=True)
            ),
            encoding="ascii",
        )
    expected = {name: digest for digest, name in (line.split() for line in frozen.read_text().splitlines())}
    for recording, (outcome, digest) in zip(recordings, results, strict=True):
        place = recording.relative_to(ROOT)
        if outcome.status != 0:
            differences.append(
                f"stator replay {place}: exit status {outcome.status}: "
                + outcome.errors.decode("utf-8", "replace").strip()
            )
        elif digest != expected.pop(recording.name, None):
            differences.append(
                f"stator replay {place} --csv signals.csv --period {PERIOD}: other signals than are "
                "frozen; compare the file with that of the program before"
            )
        else:
            continue
        expected.pop(recording.name, None)
    return differences + [f"{folder / name}: is frozen and not there" for name in expected]


PARTS = {"refused_racks": sentences, "refused_scenarios": sentences, "recordings": signals}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--freeze", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    options.stator = os.path.abspath(options.stator)
    differences = PARTS[options.part](options, DATA / options.part)
    print(*differences, sep="\n")
    if differences:
        print(
            f"{len(differences)} differences from what is frozen in tests/data/{options.part}; if they are meant, "
            f"tests/frozen/frozen.py {options.part} --stator PROGRAM --freeze"
        )
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
