#!/usr/bin/env python3
"""Does what documents say: their command lines are run in the order in which they stand, and their output compared.

    documents.py --stator PROGRAM --build FOLDER DOCUMENT...
    documents.py --left-out DOCUMENT...         runs nothing: what is not run, and why

A document is a page in Markdown, or a rack file or the like, whose head has commands.

Each document has a network, processes and a folder /tmp of its own, which end with it, so names and ports may be those of
other documents; it stands in a folder with copies of racks, examples and scenarios, with build/release, and with
`stator` and the programs of clients on its path. For that it has to run as root. blocks.py says how a document marks what
stays in the background, what is output and what is not run.
"""

import argparse
import collections
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

import blocks
from shell import PATIENCE, Failed, Shell

ROOT = pathlib.Path(__file__).resolve().parents[2]
COPIED = ("racks", "examples", "scenarios", "clients")
NAMESPACES = ("unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc")
LEFT_OUT = 77  # exit status of a test that the machine cannot do

# What a document finds beside the programs of the system. There may be no sudo, and here everybody is root.
HELPERS = """
sudo() { "$@"; }
cable() {
  ip link add "$1" type veth peer name "$2" && ip link set dev "$1" up && ip link set dev "$2" up
}
press() {
  while sleep 0.3; do printf '%b' "$1"; done | script --quiet --return --command "$2" /dev/null
}
"""


def arguments():
    """What the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", help="the program")
    parser.add_argument("--build", help="folder of the build whose examples documents start")
    parser.add_argument("--left-out", action="store_true", help="only tell what is not run")
    parser.add_argument("--inside", help=argparse.SUPPRESS)
    parser.add_argument("documents", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    if not options.left_out and not (options.stator and options.build):
        parser.error("--stator and --build are needed to run anything")
    return options


def steps_of(document, text):
    """The steps of a page, or of a file whose head has commands."""
    return blocks.read(text) if document.suffix == ".md" else blocks.read_head(text)


def short(document):
    """The name of a document as messages have it."""
    document = document.resolve()
    return document.relative_to(ROOT) if document.is_relative_to(ROOT) else document


def last_lines(text, number=30):
    """The end of what somebody has said."""
    return "\n".join(text.splitlines()[-number:])


def tell_left_out(documents):
    """Counts what is run, and what is not by its reason."""
    counted, reasons = collections.Counter(), collections.Counter()
    for document in documents:
        for step in steps_of(document, document.read_text(encoding="utf-8")):
            if step.kind == "left out":
                number = sum(1 for _ in blocks.commands(step.content.split("\n")))
                counted["command lines left out"] += number
                reasons[step.text] += number
            counted["command lines run"] += step.kind in ("command", "dialogue") and step.shown
            counted["outputs compared"] += step.kind in ("output", "dialogue")
    for what, number in sorted(counted.items()):
        print(f"{number:4} {what}")
    for reason, number in reasons.most_common():
        print(f"{number:4} not run: {reason}")


class LeftOut(Exception):
    """The machine cannot do what comes."""


class Run:
    """One document, from its first step to its last."""

    def __init__(self, shell, directory):
        self.shell = shell
        self.directory = directory
        self.block = None
        self.said = ""  # by the commands of this block that have ended
        self.counted = collections.Counter()
        self.reasons = collections.Counter()

    def do(self, step):
        """Does one step; Failed if it is not as the document says, LeftOut if the machine cannot do it."""
        getattr(self, "do_" + step.kind.replace(" ", "_"))(step)

    def do_left_out(self, step):
        self.reasons[step.text] += sum(1 for _ in blocks.commands(step.content.split("\n")))

    def do_file(self, step):
        path = self.directory / step.text
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(step.content, encoding="utf-8")

    def do_command(self, step):
        if step.text == "stop":
            self.shell.stop()
            return
        if not step.shown and step.text.startswith("heard "):
            self.hear(step.text.removeprefix("heard "))
            return
        if not step.shown and step.text.startswith("needed "):
            command, reason = step.text.removeprefix("needed ").rsplit(" # ", 1)
            if self.shell.run(command)[0]:
                raise LeftOut(reason)
            return
        if step.shown and step.block != self.block:
            self.block, self.said = step.block, ""
        self.counted["command lines run"] += step.shown
        if step.stays:
            rack = blocks.RACK.match(step.text)
            if rack:
                self.shell.stop()
            self.shell.start(step.text, "Running;" if rack else "")
            return
        command = step.text
        if step.keys:
            plain = command.split(" #")[0].strip()
            command = shlex.join(["press", step.keys, plain])
        status, output = self.shell.run(command)
        if step.shown:
            self.said += output
        if bool(status) != step.fails:
            wanted = "another than 0" if step.fails else "0"
            others = "".join(
                f"\nmeanwhile {other.command} says:\n{last_lines(other.output())}" for other in self.shell.background
            )
            raise Failed(f"{step.text}: exit status {status}, expected {wanted}; it said:\n{output}{others}")

    def hear(self, text):
        """Waits until something that stays has said this."""
        Shell.wait_for(
            lambda: any(text in program.output() for program in self.shell.background),
            lambda: f"nobody says {text!r}, but\n" + "".join(program.output() for program in self.shell.background),
        )

    def do_output(self, step):
        def difference():
            return blocks.difference(step.text, said(), step.varying)

        if step.content:  # of what stays, which may still have to say it
            newest = [program for program in self.shell.background if program.command.startswith(step.content)]
            if not newest:
                raise Failed(f"nothing that stays begins with {step.content!r}")
            said = newest[-1].output
            Shell.wait_for(lambda: not difference(), lambda: f"{difference()}\nit said:\n{said()}")
        else:
            said = lambda: self.said  # noqa: E731
            if wrong := difference():
                raise Failed(f"{wrong}\nit said:\n{said()}")
        self.counted["outputs compared"] += 1

    def do_dialogue(self, step):
        self.counted["command lines run"] += 1
        typed, expected = blocks.dialogue(step.content)
        status, output = self.shell.run(step.text, "".join(line + "\n" for line in typed))
        if status:
            raise Failed(f"{step.text}: exit status {status}; it said:\n{output}")
        wrong = blocks.difference(expected, output)
        if wrong:
            raise Failed(f"{step.text}: {wrong}\nit said:\n{output}")
        self.counted["outputs compared"] += 1


class Help:
    """What the program says of its commands and their options."""

    def __init__(self, program):
        self.program = program
        self.texts = {}

    def of(self, *words):
        """The help of a command, "" if there is no such command."""
        if words not in self.texts:
            done = subprocess.run(
                [self.program, *words, "--help"], capture_output=True, text=True, check=False, timeout=PATIENCE
            )
            self.texts[words] = done.stdout if done.returncode == 0 else ""
        return self.texts[words]

    def wrong(self, command):
        """None, or what a command names that there is not. What stands for something else, "..." or NAME, may be anything."""
        words = command.split(" -- ")[0].split()[1:]
        known, names = self.of(), ()
        while words and re.fullmatch(r"[a-z][a-z-]*", words[0]) and "\nSubcommands:" in known:
            if not re.search(rf"^  {re.escape(words[0])} ", known.split("\nSubcommands:")[1], re.MULTILINE):
                return f"there is no command {words[0]!r}"
            names += (words.pop(0),)
            known = self.of(*names)
        if not names:
            return None
        for option in re.findall(r"(?<=\s)--[a-z][a-z-]*", " " + " ".join(words)):
            if not re.search(rf"{option}(?![a-z-])", known):
                return f"stator {' '.join(names)} has no option {option}"
        return None


def have_own_places(options):
    """In namespaces of its own: a network with a loopback interface, an empty /run, where names of networks are, and an
    empty /tmp in which what is needed of the old one stays."""
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/run"], check=True)
    place = pathlib.Path(options.inside)
    new = place / "tmp"
    new.mkdir()
    temporary = pathlib.Path("/tmp")
    needed = [ROOT, pathlib.Path(options.build).resolve(), pathlib.Path(options.stator).resolve().parent]
    for path in [path for path in needed if path.is_relative_to(temporary)]:
        here = new / path.relative_to(temporary)
        here.mkdir(parents=True, exist_ok=True)
        subprocess.run(["mount", "--rbind", path, here], check=True)
    subprocess.run(["mount", "--rbind", new, temporary], check=True)
    directory = temporary / "stator-documents"
    for name in ("bin", "home", "notes", "work/build"):
        (directory / name).mkdir(parents=True)
    (directory / "bin" / "stator").symlink_to(os.path.abspath(options.stator))
    for name in COPIED:
        shutil.copytree(ROOT / name, directory / "work" / name)
    (directory / "work" / "build" / "release").symlink_to(os.path.abspath(options.build))
    return directory


def run_inside(options):
    """The steps of one document; exit status."""
    document = options.documents[0]
    began = time.monotonic()
    text = document.read_text(encoding="utf-8")
    directory = have_own_places(options)
    path = [directory / "bin", ROOT / ".cache" / "clients" / "python" / "bin"]
    environment = {
        **{name: os.environ[name] for name in ("LANG", "LD_LIBRARY_PATH", "ASAN_OPTIONS") if name in os.environ},
        "HOME": str(directory / "home"),
        "USER": "root",
        "TERM": "xterm",
        "PATH": ":".join(map(str, path)) + ":/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
    }
    # What a server refuses is a failure; no progress is shown.
    (directory / "home" / ".curlrc").write_text("fail-with-body\nsilent\n", encoding="utf-8")
    shell = Shell(directory / "work", environment, directory / "notes")
    run = Run(shell, directory / "work")
    step = blocks.Step(0, "command", "")
    try:
        shell.run("")
        shell.bash.stdin.write(HELPERS)
        for step in steps_of(document, text):
            run.do(step)
        step = blocks.Step(step.line, "command", "the end")
        shell.stop()
        program = Help(options.stator)
        for line, command in blocks.in_text(text):
            step = blocks.Step(line, "command", command, block=line)
            if wrong := program.wrong(command):
                raise Failed(f"{command}: {wrong}")
            run.counted["commands in the text looked at"] += 1
            if blocks.tells(command):
                run.do(step)
    except LeftOut as reason:
        print(f"{short(document)}:{step.line}: not run from here on\nnot tested: {reason}")
        return LEFT_OUT
    except (Failed, blocks.Mistake) as error:
        print(f"{short(document)}:{step.line}: {error}")
        return 1
    counts = ", ".join(f"{number} {what}" for what, number in run.counted.items() if number)
    print(f"{short(document)}: {counts or 'nothing is run'} in {time.monotonic() - began:.1f} s")
    for reason, number in run.reasons.items():
        print(f"  {number} not run: {reason}")
    return 0


def main():
    options = arguments()
    if options.left_out:
        tell_left_out(options.documents)
        return 0
    if options.inside:
        return run_inside(options)
    if os.geteuid() != 0 or subprocess.run([*NAMESPACES, "true"], capture_output=True, check=False).returncode != 0:
        print("not tested: needs namespaces of its own for network, mounts and processes")
        return LEFT_OUT
    results = set()
    for document in options.documents:
        with tempfile.TemporaryDirectory(prefix="stator-documents-") as inside:
            done = subprocess.run(
                [*NAMESPACES, sys.executable, "-B", os.path.abspath(__file__), "--inside", inside]
                + ["--stator", options.stator, "--build", options.build, str(document.resolve())],
                check=False,
            )
            results.add(done.returncode)
    return next((result for result in (1, LEFT_OUT) if result in results), max(results))


if __name__ == "__main__":
    sys.exit(main())
