"""Runs of tests: one without a mutant, which tells what each test reaches, and one per mutant."""

import os
import resource
import signal
import subprocess
from dataclasses import dataclass, field

REACHED, DIFFERED, LIMIT_OF_REALS = 1, 2, 4
HANGS_AFTER = 20  # times the processor time of the unmutated run
LEAST_LIMIT = 5  # seconds of processor time
FILTER_LENGTH = 100_000  # characters, below what an environment takes
FIRST_SECONDS = 1.0  # of tests that are run before all others
MEMORY = 8 << 30
STARTED, FAILED = "[ RUN      ] ", "[  FAILED  ] "  # what a test program prints before a name


@dataclass
class Test:
    suite: str
    name: str
    seconds: float
    order: int


@dataclass
class Knowledge:
    """What the run without a mutant told."""

    tests: dict = field(default_factory=dict)  # number of a mutant: tests in which it differs
    notes: dict = field(default_factory=dict)  # number of a mutant: all notes on it
    inapplicable: set = field(default_factory=set)
    failed: list = field(default_factory=list)
    count: int = 0
    seconds: float = 0.0


def record(program, suite, path, tests_filter, knowledge):
    """Runs all tests of a suite without a mutant."""
    environment = dict(os.environ, MUTANT_RECORD=str(path), GTEST_FILTER=tests_filter)
    environment.pop("MUTANT", None)
    subprocess.run(
        [program, "--gtest_brief=1"],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        cwd=path.parent,
        check=False,
    )
    before_first = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[0] == "inapplicable":
            knowledge.inapplicable.update(map(int, words[1:]))
            continue
        notes = words[1:] if words[0] == "start" else words[4:]
        marks = {int(n): int(m) for n, m in (note.split(":") for note in notes)}
        for number, mark in marks.items():
            knowledge.notes[number] = knowledge.notes.get(number, 0) | mark
        if words[0] == "start":
            before_first = marks
            continue
        knowledge.count += 1
        test = Test(suite, words[1], int(words[3]) / 1e6, knowledge.count)
        knowledge.seconds += test.seconds
        if words[2] != "passed":
            knowledge.failed.append(f"{suite}: {test.name}")
            continue
        for number, mark in {**before_first, **marks}.items():
            if mark & DIFFERED:
                knowledge.tests.setdefault(number, []).append(test)


def batches(tests, room, suites):
    """Lists of tests of one program each, in the order in which they are run: a second's worth of the
    quickest first, then the room's own suite, then those up the tree."""
    quickest = sorted(tests, key=lambda t: (t.suite != room, t.seconds, t.order))
    first, spent = [], 0.0
    for test in quickest:
        if test.suite != quickest[0].suite or spent + test.seconds > FIRST_SECONDS and first:
            break
        first.append(test)
        spent += test.seconds
    if first:
        yield first
    left = [t for t in tests if t not in first]
    for suite in sorted(suites, key=lambda s: s != room):
        of_suite = sorted((t for t in left if t.suite == suite), key=lambda t: t.order)
        batch, length = [], 0
        for test in of_suite:
            if batch and length + len(test.name) + 1 > FILTER_LENGTH:
                yield batch
                batch, length = [], 0
            batch.append(test)
            length += len(test.name) + 1
        if batch:
            yield batch


def _limit(seconds):
    def apply():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    return apply


def run(program, number, tests, folder):
    """One batch with one mutant awake: ("survived" | "killed" | "hung", name of the test)."""
    seconds = LEAST_LIMIT + int(HANGS_AFTER * sum(t.seconds for t in tests))
    environment = dict(os.environ, MUTANT=str(number), GTEST_FILTER=":".join(t.name for t in tests))
    environment.pop("MUTANT_RECORD", None)
    done = subprocess.run(
        [program, "--gtest_fail_fast", "--gtest_color=no"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        cwd=folder,
        check=False,
        preexec_fn=_limit(seconds),
    )
    if done.returncode == 0:
        return "survived", ""
    last = ""
    for line in done.stdout.decode(errors="replace").splitlines():
        if line.startswith(STARTED):
            last = line[len(STARTED) :]
        elif line.startswith(FAILED):
            break  # the rest is started only to be skipped
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return "hung", last
    return "killed", last
