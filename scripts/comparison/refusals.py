"""Sentences about rack files and scenarios, wrong ones and right ones, and where they are frozen."""

import dataclasses
import json
import os
import random
import re
import shutil
import tempfile
from pathlib import Path

from comparison.outcome import Outcome, difference, in_parallel, run, spelled
from comparison.rack_mistakes import Schema, single_keys, whole_tables

ROOT = Path(__file__).resolve().parent.parent.parent
DATA = ROOT / "tests" / "data"
RACKS, SCENARIOS = DATA / "refused_racks", DATA / "refused_scenarios"
OF_EACH_TABLE = 6  # keys that are wrong alone
TOOK = re.compile(rb"simulated in [0-9.]+ s")
HEAD = "== stator "


def sources(folder):
    return sorted(path.name for path in folder.glob("*.toml"))


def frozen_commands(folder):
    """What is frozen of a folder of wrong files."""
    if folder.name == SCENARIOS.name:
        return [["test", name] for name in sources(folder)]
    return [["check", name] for name in sources(folder)]


def sentences(program, arguments, folder):
    """Without what the machine decides."""
    outcome = run(program, arguments, folder)
    return dataclasses.replace(outcome, output=TOOK.sub(b"simulated", outcome.output))


def as_text(arguments, outcome):
    """A paragraph of the frozen file."""
    said = [part.decode("utf-8", "backslashreplace") for part in (outcome.output, outcome.errors)]
    lines = [f"{HEAD}{' '.join(arguments)}", f"exit status {outcome.status}"]
    lines += [f"{mark} {line}" for mark, text in zip("|!", said, strict=True) for line in text.splitlines()]
    return "\n".join(lines) + "\n"


def frozen_text(program, folder, jobs):
    """Everything that is frozen of a folder, as the program says it."""
    commands = frozen_commands(folder)
    outcomes = in_parallel(jobs, lambda each: sentences(program, each, folder), commands)
    return "\n".join(as_text(*each) for each in zip(commands, outcomes, strict=True))


def paragraphs(text):
    """{command: paragraph}"""
    parts = text.split(HEAD)[1:]
    return {part.partition("\n")[0]: part.rstrip() for part in parts}


def differences_from_frozen(frozen, said):
    """A text for each command that says something else than what is frozen."""
    before, now = paragraphs(frozen), paragraphs(said)
    for command in sorted(before.keys() | now.keys()):
        if before.get(command) == now.get(command):
            continue
        outcomes = [Outcome(0, text.get(command, "(not there)").encode(), b"") for text in (before, now)]
        yield f"stator {command}", difference(*outcomes)


class Work:
    """A copy of the wrong files, where runs may leave something behind."""

    def __init__(self, folder):
        self.folder = Path(folder)
        for source in (RACKS, SCENARIOS):
            shutil.copytree(source, self.folder / source.name)
        for name in ("racks", "examples"):
            shutil.copytree(ROOT / name, self.folder / name)

    def commands(self, jobs):
        """(arguments, folder); a run that is not refused ends at once."""
        for name in sources(RACKS):
            folder = self.folder / RACKS.name
            yield ["check", name], folder
            yield ["check", name, "--format", "json"], folder
            # The first mistake ends the reading here.
            yield ["run", name, "--duration", "1us", "--link", "in-process"], folder
            yield ["tune", name], folder
        for name in sources(SCENARIOS):
            yield ["test", name, "--verbose"], self.folder / SCENARIOS.name


def drawn(program, seed):
    """Wrong rack files that are made from the keys that the program knows."""
    schema = Schema(json.loads(run(program, ["check", "--schema"], ROOT).output))
    yield (
        "ten thousand unknown keys",
        "[[segment]]\n" + "".join(f"wrong{number} = {number}\n" for number in range(10000)),
    )
    yield from whole_tables(schema)
    yield from single_keys(schema, random.Random(seed), OF_EACH_TABLE)


def compare(old, new, options, report):
    with tempfile.TemporaryDirectory() as folder:
        work = Work(folder)
        commands = list(work.commands(options.jobs))
        for (arguments, place), outcomes in zip(
            commands,
            in_parallel(
                options.jobs, lambda each: tuple(sentences(program, *each) for program in (old, new)), commands
            ),
            strict=True,
        ):
            note(report, "commands on wrong files", outcomes)
            if lines := difference(*outcomes):
                report.differs(f"cd {DATA / place.name} && {spelled(arguments)}", lines)
        made = list(drawn(old, options.seed))
        for (what, text), outcomes in zip(
            made, in_parallel(options.jobs, lambda each: checked(folder, old, new, each[1]), made), strict=True
        ):
            note(report, "drawn rack files", outcomes)
            if lines := difference(*outcomes):
                report.differs(f"{what}: stator check {kept(options, text)}", lines)


def note(report, what, outcomes):
    report.count(what)
    report.count("of them refused", 1 if outcomes[0].status else 0)
    report.count("lines said", outcomes[0].output.count(b"\n") + outcomes[0].errors.count(b"\n"))


def checked(folder, old, new, text):
    with tempfile.TemporaryDirectory(dir=folder) as place:
        Path(place, "rack.toml").write_text(text, encoding="utf-8")
        return tuple(sentences(program, ["check", "rack.toml"], place) for program in (old, new))


def kept(options, text):
    """Where the file lies that shows a difference."""
    if not options.keep:
        return "(--keep DIR keeps it) <<EOF\n" + text + "EOF"
    os.makedirs(options.keep, exist_ok=True)
    number = len(os.listdir(options.keep))
    path = Path(options.keep, f"rack-{number}.toml")
    path.write_text(text, encoding="utf-8")
    return str(path)
