"""`stator run` as programs of others meet it: started, looked at, disturbed, killed, ended.

Also where such programs run: a network of their own, and priority over what else the machine does.
"""

import contextlib
import ctypes
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

PATIENCE = 60.0  # s; how long a busy machine may take for what takes none
TOKEN = "clients-of-others-0123456789"
MAY_SKIP = "STATOR_TESTS_MAY_SKIP"


def unavailable(reason, remedy):
    """Ends the program because the machine lacks something: a failure, unless the environment says that
    this is known."""
    if os.environ.get(MAY_SKIP) == "1":
        print(f"not tested: {reason}", file=sys.stderr)
        sys.exit(77)
    print(f"{reason}; {remedy}. {MAY_SKIP}=1 in the environment leaves such tests out.", file=sys.stderr)
    sys.exit(1)


def enter_python_of_clients():
    """Starts this program again in the Python that "scripts/setup clients" makes."""
    place = pathlib.Path(__file__).resolve().parents[2] / ".cache" / "clients" / "python"
    if pathlib.Path(sys.prefix) == place:
        return
    if not (place / "installed").exists():
        unavailable(f"{place} does not exist", "scripts/setup clients makes it")
    python = str(place / "bin" / "python")  # by this name it knows where its packages are
    os.execv(python, [python, os.path.abspath(sys.argv[0]), *sys.argv[1:]])


def server_environment():
    """What `stator` runs in: as the test, but without the library that only clients load."""
    return {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_until(condition, what, seconds=PATIENCE, pause=0.01):
    """What `condition` returned when it was true for the first time."""
    end = time.monotonic() + seconds
    while not (result := condition()):
        assert time.monotonic() < end, f"{what}: not within {seconds:.0f} s"
        time.sleep(pause)
    return result


class RunningRack:
    """A rack file's devices. Ends with the `with` block, by its own process number."""

    def __init__(self, program, rack, *options):
        self.program = program
        self.directory = tempfile.TemporaryDirectory(prefix="stator-client-")
        self.path = os.path.join(self.directory.name, "rack.toml")
        with open(self.path, "w", encoding="utf-8") as file:
            file.write(rack)
        token = os.path.join(self.directory.name, "token")
        with open(token, "w", encoding="utf-8") as file:
            file.write(TOKEN)
        os.chmod(token, 0o600)
        self.command = [program, "run", self.path, "--http", "0", "--http-token", token, *options]
        self.lines = []
        self.process = self.reader = None
        self.start()

    def start(self):
        """Again after kill() or stop(): a machine that was switched on."""
        seen = len(self.lines)
        self.process = subprocess.Popen(
            self.command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=server_environment()
        )
        self.reader = threading.Thread(target=self._read, args=(self.process.stdout,), daemon=True)
        self.reader.start()
        try:
            wait_until(
                lambda: self.said("^Running", seen) or self.process.poll() is not None, "stator run says that it runs"
            )
            assert self.process.poll() is None, "stator run ended"
        except AssertionError as error:
            self.kill()
            raise AssertionError(f"{error}; it said:\n{self.log()}") from None

    def _read(self, stream):
        for line in stream:
            self.lines.append(line.rstrip("\n"))

    def __enter__(self):
        return self

    def __exit__(self, kind, _error, _trace):
        self.stop()
        if kind is not None:
            print(f"stator run said:\n{self.log()}", file=sys.stderr)
        self.directory.cleanup()

    def log(self):
        return "\n".join(self.lines)

    def said(self, pattern, since=0):
        """The first line at or behind number `since` that matches."""
        return next((line for line in self.lines[since:] if re.search(pattern, line)), None)

    def wait_for(self, pattern, since=0):
        return wait_until(lambda: self.said(pattern, since), f"a line like {pattern!r} in the log")

    def _end(self, number):
        if self.process is None:
            return
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise
        finally:
            self.reader.join()
            self.process.stdout.close()
            self.process = None

    def stop(self):
        """Ends it as Ctrl-C does; the counters are the last lines of the log."""
        self._end(signal.SIGINT)

    def kill(self):
        """Without a word, as when somebody pulls the plug of everything."""
        self._end(signal.SIGKILL)

    def _remote(self, *words):
        address = re.search(r"http://[0-9.]+:\d+", self.wait_for(r"http://[0-9.]+:\d+")).group()
        done = subprocess.run(
            [self.program, words[0], "--http", address, *words[1:]],
            env={**server_environment(), "STATOR_TOKEN": TOKEN},
            text=True,
            capture_output=True,
            timeout=PATIENCE,
            check=False,
        )
        assert done.returncode == 0, f"stator {' '.join(words)}: {done.stderr}{done.stdout}"
        return done.stdout

    @contextlib.contextmanager
    def fault(self, kind, device, *keys):
        """Something goes wrong for as long as the block runs (`stator inject`, `stator clear`)."""
        said = self._remote("inject", kind, "--device", device, *keys)
        try:
            yield
        finally:
            self._remote("clear", re.search(r"\d+", said).group())


def have_own_network():
    """From now on this process and its children have a network of their own, which ends with them."""
    if ctypes.CDLL(None, use_errno=True).unshare(0x40000000) != 0:  # CLONE_NEWNET
        unavailable(f"no network namespace: {os.strerror(ctypes.get_errno())}", "run as root")
    ip("link", "set", "lo", "up")


def ip(*arguments):
    done = subprocess.run(["ip", *arguments], capture_output=True, text=True, check=False, env=server_environment())
    if done.returncode != 0:
        unavailable(f"ip {' '.join(arguments)}: {done.stderr.strip()}", "run as root, with iproute2")
    return done.stdout


def plug_cable(first, second):
    """A veth pair, both ends up and connected."""
    ip("link", "add", first, "type", "veth", "peer", "name", second)
    for end in (first, second):
        ip("link", "set", end, "up")

    wait_until(
        lambda: all("LOWER_UP" in ip("-o", "link", "show", "dev", end) for end in (first, second)),
        "the ends of the cable see each other",
    )


def preload_bus(library, bus, name=None):
    """Starts this program again as "stator can-exec" does, for a bus that is started later: its CAN sockets
    reach `bus` where they ask for an interface `name`."""
    if os.environ.get("STATOR_CAN_EXEC"):
        return
    place = f"/tmp/stator-can-exec-{os.getuid()}/{bus}"
    os.environ.update({"STATOR_CAN_EXEC": f"{name or bus}={place}", "LD_PRELOAD": os.path.abspath(library)})
    os.execv(sys.executable, [sys.executable, os.path.abspath(sys.argv[0]), *sys.argv[1:]])


def have_priority():
    """Bus masters are real-time programs: this one and its children go before all others, where allowed.
    Some time limits in libraries of masters are fixed and short, which a busy machine would break."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(10))
