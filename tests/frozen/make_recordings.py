#!/usr/bin/env python3
"""Makes the recordings that are frozen in tests/data/recordings.

  tests/frozen/make_recordings.py PROGRAM FOLDER [--candidates 150] [--seed 1] [--count 25] [--bytes 1400000] [--jobs N]

Records short sessions as scripts/compare_programs.py does and keeps those that show most: one after the other the one
with the most that no other has shown yet, measured by what it weighs.
"""

import argparse
import multiprocessing
import os
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests" / "rigs")]

from comparison import recordings  # noqa: E402
from comparison.recordings import facts_of, prepare_worker, replay  # noqa: E402
from rack_process import NotStarted, Silent  # noqa: E402

SECONDS = 0.4
PERIOD = "1ms"
SIMULATED = (0.25, 0.9)  # s; what is in the rack file begins, and slow machines are soon done
LONGEST = 150000  # bytes
EACH = 60000  # that one more weighs beside its bytes


def candidate(task):
    """(number, path, bytes, what it shows), or None."""
    program, seed, number, work = task
    with tempfile.TemporaryDirectory(prefix="stator-net-") as folder:
        try:
            session, recording, done, status, _ = recordings.recorded(program, seed, number, folder, SECONDS)
        except (NotStarted, Silent):
            return None
        size = recording.stat().st_size
        outcome, digest = replay(program, recording, Path(folder, "signals.csv"), PERIOD)
        if status != 0 or outcome.status != 0 or digest == "none" or size > LONGEST:
            return None
        if not SIMULATED[0] <= float(recordings.REPLAYED.search(outcome.output)[1]) <= SIMULATED[1]:
            return None
        path = Path(work, f"{number:03}.stator")
        shutil.copy(recording, path)
    shows = {f"fault {kind}" for kind in session.kinds} | {f"event {name}" for name in session.events}
    shows |= {name for name, count in done.items() if count}
    shows |= {f"{placed.product} in {'lockstep' if session.lockstep else 'real time'}" for placed in session.placed}
    return number, path, size, shows


def importance(what):
    return 4 if "fault" in what or "," in what else 1


def chosen(candidates, count, most):
    """Those that show most for their weight."""
    shown, taken, weight = set(), [], 0
    left = [each for each in candidates if each]
    while left and len(taken) < count:
        best = max(left, key=lambda each: (sum(map(importance, each[3] - shown)) / (each[2] + EACH), -each[2]))
        left.remove(best)
        if weight + best[2] > most:
            continue
        taken.append(best)
        shown |= best[3]
        weight += best[2]
    return sorted(taken), shown


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--candidates", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--bytes", type=int, default=1400000)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    with tempfile.TemporaryDirectory() as work:
        tasks = [(program, options.seed, number, work) for number in range(options.candidates)]
        with multiprocessing.Pool(options.jobs, prepare_worker, (facts_of(program),)) as pool:
            found = pool.map(candidate, tasks, chunksize=1)
        taken, shown = chosen(found, options.count, options.bytes)
        for old in Path(options.folder).glob("*.stator"):
            old.unlink()
        for number, path, _, shows in taken:
            kinds = sorted(what.removeprefix("fault ") for what in shows if what.startswith("fault"))
            shutil.copy(path, Path(options.folder, "-".join([f"{number:03}", *kinds[:2]]) + ".stator"))
    print(f"{len(taken)} recordings, {sum(each[2] for each in taken)} bytes; they show:")
    print(*sorted(shown), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
