"""What a program said and how it ended, and what two of them said otherwise."""

import concurrent.futures
import dataclasses
import difflib
import shlex
import subprocess

LIMIT = 120  # s; for commands that take a second
MOST_LINES = 12  # of a difference that is printed


@dataclasses.dataclass(frozen=True)
class Outcome:
    status: int | str
    output: bytes
    errors: bytes
    files: tuple = ()  # (name, content) of what it wrote

    def parts(self):
        """(name, bytes) of all that is compared."""
        return [
            ("exit status", str(self.status).encode()),
            ("output", self.output),
            ("errors", self.errors),
            *self.files,
        ]


def run(program, arguments, folder, limit=LIMIT, environment=None):
    """Runs it in `folder` without input."""
    try:
        done = subprocess.run(
            [program, *arguments],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=limit,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        return Outcome(f"not ended within {limit} s", error.stdout or b"", error.stderr or b"")
    return Outcome(done.returncode, done.stdout, done.stderr)


def difference(old, new):
    """Lines that tell what differs between two outcomes; none if nothing does."""
    lines = []
    for (name, before), (_, now) in zip(old.parts(), new.parts(), strict=True):
        if before == now:
            continue
        texts = [part.decode("utf-8", "backslashreplace").splitlines() for part in (before, now)]
        changed = [
            line
            for line in difflib.unified_diff(*texts, "old", "new", lineterm="", n=0)
            if not line.startswith(("---", "+++", "@@"))
        ]
        lines.append(f"  {name}: {len(before)} bytes, now {len(now)}" + ("" if changed else "; ends of lines differ"))
        lines += [f"    {line[:300]}" for line in changed[:MOST_LINES]]
        if len(changed) > MOST_LINES:
            lines.append(f"    and {len(changed) - MOST_LINES} lines more")
    return lines


def spelled(arguments):
    return "stator " + shlex.join(str(argument) for argument in arguments)


class Report:
    """Counts of a part, and every difference as it is found."""

    def __init__(self, part):
        self.part = part
        self.counts = {}
        self.differences = 0

    def count(self, what, number=1):
        self.counts[what] = self.counts.get(what, 0) + number

    def differs(self, repeat, lines):
        """`repeat` is the command that shows it."""
        self.differences += 1
        print(f"{self.part}: {repeat}", *lines, sep="\n", flush=True)

    def line(self):
        counts = ", ".join(f"{number} {what}" for what, number in self.counts.items())
        return f"{self.part}: {counts or 'nothing'}; {self.differences} differ"


def in_parallel(jobs, function, items):
    """Results in the order of the items."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(function, items)
