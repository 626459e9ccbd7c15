"""`stator run` as the rigs have it: started in milliseconds, killed or ended at any moment, again and again."""

import contextlib
import os
import select
import signal
import subprocess
import time

PATIENCE = 60.0  # s; how long a busy machine may take for what takes a blink


class Gone(Exception):
    """The program at the other end is not there any more."""


class Silent(Exception):
    """The program lives, and does not answer."""


class NotStarted(Exception):
    """It ended instead of running; carries its exit status and what it said."""

    def __init__(self, status, said):
        super().__init__(f"stator run ended with status {status}: {said.strip()}")
        self.status = status
        self.said = said


def own_address():
    """An address of this machine that no other process uses, so that ports can be the same everywhere."""
    return f"127.{64 + (os.getpid() >> 16) % 64}.{(os.getpid() >> 8) % 256}.{os.getpid() % 256}"


class RackProcess:
    """One run of a rack file. `said` is what came on standard output, `log()` what came on standard error."""

    def __init__(self, program, rack, directory, *options, patience=PATIENCE, **popen):
        self.said = ""
        self.interrupted = False
        self.log_path = os.path.join(directory, "stderr")
        with open(self.log_path, "wb") as log:
            self.process = subprocess.Popen(
                [program, "run", rack, *options],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                **{"stderr": log, **popen},
            )
        try:
            self._wait_until_it_runs(patience)
        except BaseException:
            self.kill()
            raise

    def _wait_until_it_runs(self, patience):
        end = time.monotonic() + patience
        stream = self.process.stdout.fileno()
        while "Running;" not in self.said:
            left = end - time.monotonic()
            if left < 0 or not select.select([stream], [], [], left)[0]:
                raise Silent(f"stator run does not say within {patience:.0f} s that it runs")
            data = os.read(stream, 65536)
            if not data:
                raise NotStarted(self.process.wait(PATIENCE), self.log())
            self.said += data.decode("utf-8", "replace")

    def log(self):
        with open(self.log_path, "rb") as log:
            return log.read(1 << 20).decode("utf-8", "replace")

    def send(self, number):
        """Nothing happens if it has ended already, or was asked to before: a second SIGINT ends it at once."""
        if self.process.returncode is None and not (number == signal.SIGINT and self.interrupted):
            self.interrupted = number == signal.SIGINT
            self.process.send_signal(number)

    def end(self, number=signal.SIGINT, patience=PATIENCE):
        """Exit status and seconds until it had ended; Silent if it does not end."""
        begin = time.monotonic()
        self.send(number)
        try:
            status = self.process.wait(patience)
        except subprocess.TimeoutExpired:
            self.kill()
            raise Silent(f"stator run has not ended {patience:.0f} s after signal {number}") from None
        seconds = time.monotonic() - begin
        with contextlib.suppress(ValueError):
            self.said += self.process.stdout.read().decode("utf-8", "replace")
            self.process.stdout.close()
        return status, seconds

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()
