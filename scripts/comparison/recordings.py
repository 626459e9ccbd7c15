"""Sessions recorded with one program and replayed by both, signal by signal."""

import collections
import hashlib
import itertools
import multiprocessing
import os
import re
import shutil
import signal
import tempfile
import traceback
from pathlib import Path

from comparison import products, sessions
from comparison.outcome import difference, run
from comparison.texts import TIMES
from rack_process import NotStarted, Silent

PERIOD = "100us"
CUT = 3  # exit status of a replay whose recording lacks its end
LOOK = 50  # of so many rows one is looked at
SECONDS = 0.7  # that masters of a session have
LIMIT = 300  # s, for a replay
REPLAYED = re.compile(rb"([0-9.]+) s with ([0-9]+) EtherCAT frames, ([0-9]+) CAN frames and ([0-9]+) serial bytes")


def replay(program, recording, csv, period=PERIOD):
    """The outcome without the machine's speed, and the SHA-256 of all signals; "none" without any."""
    arguments = ["replay", str(recording), "--csv", str(csv), "--period", period]
    outcome = run(program, arguments, csv.parent, LIMIT)
    digest = "none"
    if csv.exists():
        with csv.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return outcome, digest


def said(outcome, recording):
    """Without times, and without where the recording lies."""
    output, errors = (
        TIMES.sub(rb"\1 (time)", part).replace(str(recording).encode(), b"RECORDING")
        for part in (outcome.output, outcome.errors)
    )
    return type(outcome)(outcome.status, output, errors)


def first_other_value(old, new):
    """Time and signal at which two files of signals differ first."""
    with old.open(encoding="utf-8") as one, new.open(encoding="utf-8") as other:
        names = []
        for number, (before, now) in enumerate(itertools.zip_longest(one, other)):
            if before == now:
                names = names or before.rstrip().split(",")
                continue
            if before is None or now is None:
                return f"  one ends in row {number}, the other goes on"
            values = zip(before.rstrip().split(","), now.rstrip().split(","), strict=False)
            at = next((at for at, pair in enumerate(values) if pair[0] != pair[1]), 0)
            name = names[at] if at < len(names) else "column"
            return (
                f"  row {number} ({before.split(',')[0]} s), {name}: {before.split(',')[at : at + 1]}, now "
                f"{now.split(',')[at : at + 1]}"
            )
    return "  no value does, in rows of the same length"


def compared(old, new, recording, folder):
    """Lines about what both programs make of a recording, and what the old one said."""
    csvs = [Path(folder, f"{name}.csv") for name in ("old", "new")]
    outcomes, digests = zip(
        *(replay(program, recording, csv) for program, csv in zip((old, new), csvs, strict=True)), strict=True
    )
    lines = difference(*(said(outcome, recording) for outcome in outcomes))
    if digests[0] != digests[1]:
        lines.append(f"  signals: SHA-256 {digests[0][:16]}..., now {digests[1][:16]}...")
        if "none" not in digests:
            lines.append(first_other_value(*csvs))
    if outcomes[0].status not in (0, CUT):
        lines.append(
            f"  OLD does not replay it (exit status {outcomes[0].status}): "
            + outcomes[0].errors.decode("utf-8", "replace").strip()[:400]
        )
    return lines, outcomes[0], counts_of(csvs[0])


def counts_of(csv):
    """How much there is in a file of signals, so that nobody believes in recordings in which nothing happens."""
    if not csv.exists():
        return {}
    with csv.open("rb") as stream:
        names = stream.readline().split(b",")
        first = stream.readline().split(b",")
        changed, number = set(), 1 if first[0] else 0
        for number, row in enumerate(stream, 2):
            if number % LOOK == 0:
                changed.update(
                    name for name, before, now in zip(names, first, row.split(b","), strict=False) if before != now
                )
    turned = sum(b"shaft_position [" in name or b".position [" in name for name in changed)
    return {
        "rows of signals": number,
        "signals": len(names) - 1,
        "signals that change": len(changed),
        "shafts that turn": turned,
    }


FACTS = {}  # of the program; set once in each process


def prepare_worker(facts):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent's to react to
    FACTS.update(facts)


def facts_of(program):
    return {"products": products.load(program), "faults": products.load_faults(program)}


def recorded(program, seed, number, folder, seconds=SECONDS):
    """(session, recording, counts of what was done, exit status, log)"""
    sessions.prepare(folder)
    session = sessions.Session(seed, number, FACTS["products"], FACTS["faults"])
    return session, *sessions.record(program, session, folder, seconds)


def one(task):
    """Records and compares a session: (number, lines about differences, counts, kinds of faults)."""
    old, new, seed, number, keep = task
    counts = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="stator-net-") as folder:
        try:
            session, recording, done, status, log = recorded(old, seed, number, folder)
            counts.update(done)
            lines, outcome, shown = compared(old, new, recording, folder)
        except (NotStarted, Silent) as reason:
            return number, [f"  OLD does not run it: {reason}"], counts, []
        except Exception:  # a mistake here must not end the others
            return number, [traceback.format_exc()], counts, []
        if outcome.status == CUT:
            counts["cut, since this machine was too slow"] += 1
        elif status != 0:
            lines.append(f"  OLD ended with exit status {status}: {log[-300:]}")
        counts.update({f"event {name}": count for name, count in session.events.items()})
        counts.update(f"with a {placed.product}" for placed in session.placed)
        counts.update(["in lockstep" if session.lockstep else "in real time"])
        counts.update({**shown, "bytes recorded": recording.stat().st_size})
        if match := REPLAYED.search(outcome.output):
            simulated, *frames = match.groups()
            counts.update({"simulated ms": int(float(simulated) * 1000)})
            counts.update(dict(zip(("EtherCAT frames", "CAN frames", "serial bytes"), map(int, frames), strict=True)))
        if lines and keep:
            os.makedirs(keep, exist_ok=True)
            shutil.copy(recording, Path(keep, f"session-{seed}-{number}.stator"))
            shutil.copy(Path(folder, "rack.toml"), Path(keep, f"session-{seed}-{number}.toml"))
        return number, lines, counts, session.kinds


def compare(old, new, options, report):
    facts = facts_of(old)
    tasks = [(old, new, options.seed, number, options.keep) for number in range(options.count)]
    total, kinds = collections.Counter(), collections.Counter()
    with multiprocessing.Pool(options.jobs, prepare_worker, (facts,)) as pool:
        for number, lines, counts, found in pool.imap_unordered(one, tasks):
            report.count("recordings")
            total += counts
            kinds.update(found)
            if lines:
                kept = f"; kept: {options.keep}/session-{options.seed}-{number}.stator" if options.keep else ""
                report.differs(f"--only recordings --seed {options.seed}, session {number}{kept}", lines)
    print("recordings hold: " + ", ".join(f"{count} {name}" for name, count in sorted(total.items())))
    missing = [fault.kind for fault in facts["faults"] if fault.kind not in kinds]
    print(
        f"kinds of faults in them: {len(kinds)} of {len(facts['faults'])}"
        + (f"; not {', '.join(missing)}" if missing else "")
    )
