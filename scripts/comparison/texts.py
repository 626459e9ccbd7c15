"""Every text that the program makes of what it knows: lists, descriptions, files for masters, help."""

import contextlib
import dataclasses
import json
import re
import tempfile
from pathlib import Path

from comparison.outcome import Outcome, difference, in_parallel, run, spelled

ROOT = Path(__file__).resolve().parent.parent.parent
FORMATS = ("table", "csv", "json", "markdown")
# Of "describe"; a flag that its help names and that stands here nowhere gets in by itself.
FORMS = (
    [],
    ["--registers"],
    ["--registers", "--preset", "document"],
    ["--registers", "--preset", "silicon"],
    ["--parameters", "axis"],
    ["--parameters", "global"],
)
NO_FORMS = ("--help", "--format", "--preset", "--parameters", "--registers")
# Refused, each with a sentence of its own.
REFUSED = """
describe
describe nothing
describe tmcm3315
describe tmcc160 --format xml
describe tmc8461 --registers --preset nothing
describe tmcm-142 --preset silicon
describe tmc8461 --mfc --peripherals
describe tmcc160 --signals --inputs
export sii nothing
export esi
export pdf tmcc160
export content nowhere/nothing
faults nothing
faults can-drip
conformance nothing
check
check --schema racks/gantry.toml
mfc config
mfc config nothing.toml
test
test nothing.toml
replay
replay nothing.stator
run
run nothing.toml
run --device nothing
run --device tmcm3315
run --device tmcm-3315 --link can:vcan0
run --device tmcc160 --link udp:1.2.3.4
run --device tmcm-3315 --port slcan:/tmp/x
run --device tmc8670 --serial rs485=pty:/tmp/x
run --device tmcm-3315 --spi unix:/tmp/x
run --device tmcc160 --count 200
run --device tmcc160 --bit-rate fast
simulate
simulate nothing
simulate move racks/gantry.toml --axis 7
simulate move --motor QSH5718-55-30-099
simulate move racks/can-drive.toml
simulate move --supply 12Nm
tune racks/gantry.toml
tune tmc8670 --motor none
tmcl
tmcl assemble examples/tmcl/turns.tmc --device tmcm-3315
tmcl run examples/tmcl/turns.tmc --device tmcc160
nothing
"""
TIMES = re.compile(rb"(simulated in |replayed in )[0-9.]+ s(, [0-9.]+ times real time)?")


def of_rows(text):
    """First words of the lines below the head."""
    return [line.split()[0] for line in text.decode().splitlines()[1:] if line.strip()]


def commands_in(help_text):
    """Names below "Subcommands:" of a help."""
    _, found, rest = help_text.decode().partition("ubcommands:\n")
    if not found:
        _, found, rest = help_text.decode().partition("SUBCOMMANDS:\n")
    names = []
    for line in rest.splitlines():
        match = re.match(r"  ([a-z][a-z0-9-]*)(\s|$)", line)
        if match:
            names.append(match[1])
        elif line and not line.startswith(" "):
            break
    return names


class Questions:
    """What there is to ask, as a program says itself."""

    def __init__(self, program):
        self.program = program
        self.products = of_rows(self._ask("devices"))
        schema = {}
        with contextlib.suppress(ValueError):  # what else comes is a difference
            schema = json.loads(self._ask("check", "--schema"))
        for name in types_in(schema):
            if name not in self.products:
                self.products.append(name)
        self.faults = of_rows(self._ask("faults"))

    def _ask(self, *arguments):
        return run(self.program, arguments, ROOT).output

    def all(self):
        yield from self._helps([])
        yield from (
            ["devices"],
            ["check", "--schema"],
            ["check", "--reference"],
            ["test", "--schema"],
            ["test", "--reference"],
            ["test", "--steps"],
            ["test", "--list", "scenarios"],
            ["faults"],
            ["faults", "--format", "markdown"],
        )
        yield from (["faults", kind] for kind in self.faults)
        yield from (["faults", kind, "--format", "markdown"] for kind in self.faults)
        yield from self._descriptions()
        for product in self.products:
            yield from (["export", kind, product] for kind in ("sii", "esi", "eds"))
        for product in [[], *([product] for product in self.products)]:
            for form in ("text", "csv", "json"):
                yield ["conformance", *product, "--format", form]
                yield from (
                    ["conformance", *product, "--format", form, "--status", status]
                    for status in ("done", "simplified", "left-out", "open")
                )
        for path in self._paths("examples/mfc", "*.toml"):
            yield from (["mfc", "config", path, "--format", form] for form in ("table", "csv"))
        for path in self._paths("examples/tmcl", "*.tmc"):
            yield from (
                ["tmcl", "assemble", path, "--format", form] for form in ("hex", "telegrams", "listing", "binary")
            )
        for path in self._paths("racks", "**/*.toml"):
            yield from (["check", path], ["check", path, "--format", "json"])
        yield []
        yield from (line.split() for line in REFUSED.split("\n") if line)

    @staticmethod
    def _paths(folder, pattern):
        return [str(path.relative_to(ROOT)) for path in sorted((ROOT / folder).glob(pattern))]

    def _helps(self, command):
        arguments = [*command, "--help"]
        yield arguments
        for name in commands_in(self._ask(*arguments)):
            yield from self._helps([*command, name])

    def _descriptions(self):
        flags = re.findall(r"--[a-z][a-z-]*", self._ask("describe", "--help").decode().partition("Examples")[0])
        forms = [*FORMS, *([flag] for flag in dict.fromkeys(flags) if flag not in NO_FORMS)]
        for product in self.products:
            for form in forms:
                yield from (["describe", product, *form, "--format", kind] for kind in FORMATS)


def types_in(schema):
    """Products that a rack file can have."""
    found = []
    if isinstance(schema, dict):
        if (kinds := schema.get("type")) and isinstance(kinds, dict) and "Product" in kinds.get("description", ""):
            found += kinds.get("enum", [])
        schema = list(schema.values())
    if isinstance(schema, list):
        for part in schema:
            found += types_in(part)
    return found


def asked(program, arguments):
    """An outcome without how long it took."""
    outcome = run(program, arguments, ROOT)
    return dataclasses.replace(outcome, output=TIMES.sub(rb"\1 (time)", outcome.output))


# Files that are written beside what is printed: (arguments, names).
WRITTEN = [
    (
        ["mfc", "config", str(ROOT / "examples/mfc" / name), "--sii", "image.bin", "--esi", "device.xml"],
        ("image.bin", "device.xml"),
    )
    for name in ("io-board.toml", "motion.toml")
]
WRITTEN += [
    (["simulate", "move", str(ROOT / "racks/gantry.toml"), "--csv", "move.csv"], ("move.csv",)),
    (["tune", "tmc8670", "-o", "tuned.toml"], ("tuned.toml",)),
    (["tune", str(ROOT / "racks/ethercat-servo.toml"), "-o", "tuned.toml"], ("tuned.toml",)),
    (["test", str(ROOT / "scenarios"), "--verbose"], ()),
]


def written(program, arguments, names):
    with tempfile.TemporaryDirectory() as folder:
        outcome = run(program, arguments, folder)
        files = [(name, path.read_bytes() if (path := Path(folder, name)).exists() else b"(none)") for name in names]
        output = TIMES.sub(rb"\1 (time)", outcome.output)
        return Outcome(outcome.status, output, outcome.errors, tuple(files))


def compare(old, new, options, report):
    questions = [*Questions(old).all()]
    # What only the new program has, to be told as well.
    known = {tuple(arguments) for arguments in questions}
    questions += [arguments for arguments in Questions(new).all() if tuple(arguments) not in known]
    for arguments, outcomes in zip(
        questions, in_parallel(options.jobs, lambda each: (asked(old, each), asked(new, each)), questions), strict=True
    ):
        report.count("commands")
        report.count("bytes", sum(len(part) for _, part in outcomes[0].parts()))
        if outcomes[0].status:
            report.count("of them refused")
        if lines := difference(*outcomes):
            report.differs(spelled(arguments), lines)
    experiments = [
        (["simulate", name, "--csv", "curves.csv"], ("curves.csv",))
        for name in commands_in(run(old, ["simulate", "--help"], ROOT).output)
    ]
    for arguments, names in [*WRITTEN, *experiments]:
        report.count("commands with files")
        if lines := difference(written(old, arguments, names), written(new, arguments, names)):
            report.differs(spelled(arguments), lines)
