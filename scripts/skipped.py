#!/usr/bin/env python3
"""Lists what tests of the last run of CTest left out, and why.

    scripts/skipped.py BUILD_FOLDER

Tests leave out what the machine cannot do: GoogleTest's GTEST_SKIP, skipTest of Python's unittest. RULES says by the
reason that a test gives whether it can: with STATOR_TESTS_MAY_SKIP=0 in the environment, as .ci/run has it, a test that
left out what the machine can do is a failure, and so is a reason that no rule knows.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

MAY_SKIP = "STATOR_TESTS_MAY_SKIP"

BLOCK = re.compile(r'^Output:\n-+\n(.*?)^<end of output>.*?^"(.*?)" end time', re.MULTILINE | re.DOTALL)
GTEST = re.compile(r": Skipped\n(.*?)\n+\[  SKIPPED \] (\S+)", re.DOTALL)
UNITTEST = re.compile(r"^(\S+) \((\S+)\).*? \.\.\. skipped (?:'(.*)'|\"(.*)\")$", re.MULTILINE)
PROGRAM = re.compile(r"^not tested: (.*)$", re.MULTILINE)


def works(*command):
    """Whether a command ends well; in a network of its own where it changes one."""
    try:
        return subprocess.run(command, capture_output=True, timeout=60, check=False).returncode == 0
    except OSError:
        return False


def network(*arguments):
    return works("unshare", "--net", "ip", *arguments)


# What tests say, and whether the machine can do what they need.
RULES = (
    (
        re.compile(r"needs a (network namespace|veth pair)"),
        lambda: network("link", "add", "one", "type", "veth", "peer", "name", "other"),
    ),
    (
        re.compile(r"needs a TAP interface"),
        lambda: network("tuntap", "add", "dev", "one", "mode", "tap"),
    ),
    (
        re.compile(r"needs namespaces of its own for network, mounts and processes"),
        lambda: works("unshare", "--net", "--mount", "--pid", "--fork", "--mount-proc", "true"),
    ),
    (re.compile(r"real-time priority \d+ is not permitted"), lambda: works("chrt", "--fifo", "1", "true")),
    (re.compile(r"needs a second user to change to"), lambda: os.geteuid() == 0),
    # Any machine has what a script installs.
    (re.compile(r"is not installed; scripts/setup test$"), lambda: True),
    # scripts/can-vm has a kernel with CAN for these.
    (re.compile(r"no interface of a kernel with CAN is named"), lambda: False),
    # Nothing that any machine could do.
    (re.compile(r"with this sanitizer nothing is locked"), lambda: False),
    (re.compile(r"^(the protocol has none|this interface of python-can always hears them)$"), lambda: False),
    (re.compile(r"^--library is not given$"), lambda: False),
)


def skipped(log):
    """Name and reason of each test that a log of CTest says was left out."""
    found = {}
    for output, name in BLOCK.findall(log):
        for reason, test in GTEST.findall(output):
            found[test] = " ".join(reason.split())
        for test, place, single, double in UNITTEST.findall(output):
            found[f"{name}, {place.removeprefix('__main__.') or test}"] = single or double
        for reason in PROGRAM.findall(output):
            found[name] = reason
    return sorted(found.items())


def can_do(reason):
    """Whether the machine can do what a test needed; what nobody knows of, it can."""
    return next((can() for pattern, can in RULES if pattern.search(reason)), True)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    log = Path(sys.argv[1], "Testing", "Temporary", "LastTest.log")
    if not log.exists():
        sys.exit(f"{log} does not exist; run ctest first")
    # Devices print what is no UTF-8.
    tests = skipped(log.read_text(encoding="utf-8", errors="replace"))
    wrong = 0
    for name, reason in tests:
        possible = can_do(reason)
        wrong += possible
        print(f"left out: {name}: {reason}{' - but this machine can do that' if possible else ''}")
    if wrong and os.environ.get(MAY_SKIP) == "0":
        print(f"{wrong} tests left out what this machine can do, or why is not in RULES of scripts/skipped.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
