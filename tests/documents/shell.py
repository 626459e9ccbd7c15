"""A shell that does the command lines of a document, one after the other, and the programs that stay meanwhile."""

import itertools
import os
import pathlib
import re
import select
import shlex
import subprocess
import time

PATIENCE = 120.0  # s; ends what hangs, on a busy machine too
PAUSE = 0.05  # s

# What is asked over a network is asked in time: masters' limits are some milliseconds, which a busy machine breaks.
OVER_A_NETWORK = re.compile(r"--link|--port|ethercat:|\bstator run\b|can-exec|\bpython3\b")


class Failed(Exception):
    """A command did not do what the document says."""


class Background:
    """A program that was started and goes on."""

    def __init__(self, command, process, output, rack):
        self.command = command
        self.process = process
        self.path = output
        # A rack ends in order; most other programs leave Ctrl-C to the system.
        self.may_end_with = () if rack else (130,)

    def output(self):
        """All that it has said up to now."""
        return self.path.read_text(encoding="utf-8", errors="replace")


class Shell:
    """bash, with what it keeps from line to line: variables, its folder, programs in the background."""

    def __init__(self, directory, environment, notes):
        """`notes` is a folder for what the shell is told and what commands say."""
        self.notes = pathlib.Path(notes)
        self.numbers = itertools.count()
        self.background = []
        answers, self.told = os.pipe()
        self.answers = os.fdopen(answers, "r", encoding="utf-8")
        # Job control gives each command a process group, and lets those in the background hear SIGINT.
        self.bash = subprocess.Popen(
            ["bash", "--norc", "--noprofile", "-s"],
            cwd=directory,
            env=environment,
            stdin=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            pass_fds=[self.told],
            text=True,
        )
        os.close(self.told)
        self.bash.stdin.write("set -m\n")

    def _ask(self, line, what, answer="$?"):
        """The number that bash has after a line, its exit status or another."""
        self.bash.stdin.write(f"{line}\necho {answer} >&{self.told}\n")
        self.bash.stdin.flush()
        if not select.select([self.answers], [], [], PATIENCE)[0]:
            raise Failed(f"{what}: has not ended within {PATIENCE:.0f} s")
        answer = self.answers.readline().strip()
        if not answer:
            raise Failed(f"{what}: the shell has ended")
        return int(answer)

    def _source(self, command):
        number = next(self.numbers)
        source, output = self.notes / f"{number}.sh", self.notes / f"{number}.output"
        source.write_text(command + "\n", encoding="utf-8")
        output.touch()
        return shlex.quote(str(source)), output

    def _prioritise(self, command):
        if OVER_A_NETWORK.search(command):
            self.bash.stdin.write("chrt --rr --pid 10 $$ >/dev/null 2>&1\n")

    def _go_back(self):
        self.bash.stdin.write("chrt --other --pid 0 $$ >/dev/null 2>&1\n")

    def run(self, command, stdin=""):
        """Exit status and output of a command that ends."""
        source, output = self._source(command)
        typed = self.notes / (output.name + ".input")
        typed.write_text(stdin, encoding="utf-8")
        self._prioritise(command)
        where = f"<{shlex.quote(str(typed))} >{shlex.quote(str(output))} 2>&1"
        try:
            status = self._ask(f". {source} {where} {self.told}>&-", command)
        except Failed as error:
            raise Failed(f"{error}; it said:\n{output.read_text(encoding='utf-8', errors='replace')}") from None
        self._go_back()
        return status, output.read_text(encoding="utf-8", errors="replace")

    def start(self, command, said=""):
        """Starts what stays; when `said` is given, waits until it says so, at the begin of a line."""
        # Without job control of its own, all that the copy of the shell starts is in its process group.
        source, output = self._source("set +m\n" + command.rstrip().removesuffix("&"))
        self._prioritise(command)
        process = self._ask(f". {source} </dev/null >{shlex.quote(str(output))} 2>&1 {self.told}>&- &", command, "$!")
        self._go_back()
        started = Background(command, process, output, rack=bool(said))
        self.background.append(started)
        if said:
            self.wait_for(
                lambda: re.search("^" + said, started.output(), re.MULTILINE) or not self.goes_on(started),
                lambda: f"{command}: says nothing like {said!r}, but:\n{started.output()}",
            )
            if not re.search("^" + said, started.output(), re.MULTILINE):
                self.background.remove(started)
                raise Failed(f"{command}: has ended:\n{started.output()}")
        return started

    @staticmethod
    def wait_for(condition, what):
        """Returns when the condition is true; `what` tells what was missing if it never is."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise Failed(what())
            time.sleep(PAUSE)

    def close(self):
        """Ends the shell; what stays has to be ended before."""
        self.bash.stdin.close()
        self.bash.wait(PATIENCE)
        self.answers.close()

    def goes_on(self, program):
        """Whether it has not ended by itself."""
        return self._ask(f"kill -0 {program.process} 2>/dev/null", "kill -0") == 0

    def stop(self):
        """Ends what stays, the newest first, as Ctrl-C does; each has to end well."""
        while self.background:
            program = self.background.pop()
            status = self._ask(f"kill -INT -{program.process} 2>/dev/null; wait {program.process}", program.command)
            if status not in (0, *program.may_end_with):
                raise Failed(f"{program.command}: ended with status {status} and said:\n{program.output()}")
