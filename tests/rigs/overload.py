#!/usr/bin/python3
"""Racks that are too slow for real time, and racks beside pipes, files, disks and programs that stall: does the
rack go on answering, and how long does it take to end after SIGINT?

    overload.py --stator PROGRAM [--count 5] [--seed 1] [--only CASE]... [--limit 1.0] [--factor 5] [--list]

--count is of runs for each case, one after the other. Every second run gets another SIGINT if it has not ended
after some milliseconds, behind which the time is taken anew. --limit is the seconds that an end may take on a
quiet machine, --factor how much slower this one may be; the same holds for the longest time in which a frame had
no answer while something stalled. Exit status 1 if a limit is passed. Disks that stall need root.
"""

import argparse
import base64
import contextlib
import fcntl
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

from ethercat_host import Refused, Slave
from kept_devices import CAN_PORT, ETHERCAT_PORT, SERIAL_PORT, segment
from places import have_own_mounts
from rack_process import Gone, NotStarted, RackProcess, Silent, own_address
from stalling_disk import StallingDisk

SET_PIPE_SIZE, PAGE = 1031, 4096
STALL = 2.0  # s
NEVER = 20.0  # s after which a run is killed
HTTP_PORT = 8080
BUS = '[[bus]]\nbit_rate = "unlimited"\nports = [{ports}]\n'


def fill_pipe(reading_end):
    """Leaves no room in it, as if nobody had read for long."""
    fcntl.fcntl(reading_end, SET_PIPE_SIZE, PAGE)
    descriptor = os.open(f"/proc/self/fd/{reading_end}", os.O_WRONLY | os.O_NONBLOCK)
    try:
        for size in (PAGE, 1):
            with contextlib.suppress(BlockingIOError):
                while True:
                    os.write(descriptor, bytes(size))
    finally:
        os.close(descriptor)


class Watch(threading.Thread):
    """Asks for something every millisecond, and knows the longest time in which no answer came."""

    def __init__(self, address, refused):
        super().__init__(daemon=True)
        self.slave = Slave(address, ETHERCAT_PORT)
        self.refused = refused  # requests that the device tells of in its log
        self.gap = 0.0
        self.asked = time.monotonic()
        self.ended = False

    def run(self):
        with contextlib.suppress(Gone, Silent, Refused):
            if self.refused:
                self.slave.open_mailbox()
            while not self.ended:
                self.asked = time.monotonic()
                if self.refused:
                    with contextlib.suppress(Refused):
                        self.slave.upload(0x5FFF, 0)
                else:
                    self.slave.read(0x0130, 2)
                self.gap = max(self.gap, time.monotonic() - self.asked)
                time.sleep(0.001)

    def end(self):
        """The longest time without an answer, the last one included."""
        gap = max(self.gap, time.monotonic() - self.asked if self.is_alive() else 0.0)
        self.ended = True
        return gap


class Case:
    """What is run, and what stalls. `rack` is a rack file; `options` and the rest may be overridden."""

    def __init__(self, address, directory, rng):
        self.address = address
        self.directory = pathlib.Path(directory)
        self.rng = rng
        self.popen = {}
        self.open = contextlib.ExitStack()

    watched = True
    refused = False

    def rack(self):
        return segment("tmc8670", "tmcm-3315").format(address=self.address)

    def options(self):
        return []

    def stall(self, process):
        pass

    def close(self):
        self.open.close()


class ManyDrives(Case):
    watched = False

    def rack(self):
        return (
            segment(*["tmc8670"] * 300)
            .format(address=self.address)
            .replace('type = "tmc8670"', 'type = "tmc8670"\nname = "{}"')
            .format(*range(300))
        )


class ManyNodes(Case):
    watched = False

    def rack(self):
        return BUS.format(ports=f'"slcan-tcp:{self.address}:{CAN_PORT}"') + "".join(
            f'[[bus.device]]\ntype = "tmcc160"\nname = "n{node}"\nnode_id = {node}\nfriendly = true\n'
            for node in range(1, 128)
        )


class ManyModules(Case):
    watched = False

    def rack(self):
        return "".join(
            f'[[device]]\ntype = "tmcm-142"\nname = "m{number}"\naddress = {number % 250 + 1}\n'
            f'rs485 = "tcp:{self.address}:{SERIAL_PORT + number}"\n'
            for number in range(400)
        )


class UnreadErrors(Case):
    """Standard error is a pipe that nobody reads, while a master does what is refused and told."""

    refused = True

    def options(self):
        reading, writing = os.pipe()
        self.open.callback(os.close, reading)
        self.open.callback(os.close, writing)
        self.reading = reading
        self.popen["stderr"] = writing
        return []

    def stall(self, process):
        fill_pipe(self.reading)


class UnreadOutput(Case):
    def stall(self, process):
        fill_pipe(process.process.stdout.fileno())


class Fifo(Case):
    """A file that is written while the rack runs is a pipe somebody opened and does not read."""

    NAME = "out"

    def options(self):
        path = self.directory / self.NAME
        os.mkfifo(path)
        reading = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        self.open.callback(os.close, reading)
        fcntl.fcntl(reading, SET_PIPE_SIZE, PAGE)
        return self.writing(str(path))

    def writing(self, path):
        raise NotImplementedError


class FifoTable(Fifo):
    NAME = "out.csv"

    def writing(self, path):
        return ["--record", path]


class FifoCapture(Fifo):
    NAME = "out.pcap"

    def writing(self, path):
        return ["--capture", path]


class FifoSession(Fifo):
    NAME = "out.stator"

    def writing(self, path):
        return ["--record", path]


class Stalling(Case):
    def options(self):
        self.disk = StallingDisk(self.directory / "disk")
        self.open.callback(self.disk.close)
        return self.writing(str(self.disk.path))

    def stall(self, process):
        self.disk.stall()

    def writing(self, path):
        raise NotImplementedError


class StallingTable(Stalling):
    def writing(self, path):
        return ["--record", f"{path}/out.csv"]


class StallingCapture(Stalling):
    def writing(self, path):
        return ["--capture", f"{path}/out.pcap"]


class StallingSession(Stalling):
    def writing(self, path):
        return ["--record", f"{path}/out.stator"]


class StallingState(Stalling):
    """An order to keep something is never done; what does not wait for it goes on."""

    def writing(self, path):
        return ["--state", f"{path}/state"]

    def stall(self, process):
        super().stall(process)
        slave = Slave(self.address, ETHERCAT_PORT, 1)
        self.open.callback(slave.close)
        slave.write(0x0508, b"\x12\x34")
        slave.write(0x0502, b"\x01\x02\xc0\x03\0\0")


class UnreadStream(Case):
    """A browser that subscribed to every signal at 20 kHz and does not read."""

    def options(self):
        return ["--http", f"{self.address}:{HTTP_PORT}", "--http-token", self.token()]

    def token(self):
        path = self.directory / "token"
        path.write_text("overload-rig-token-0123456789", encoding="ascii")
        path.chmod(0o600)
        return str(path)

    def stall(self, process):
        for _ in range(4):
            browser = socket.create_connection((self.address, HTTP_PORT))
            self.open.callback(browser.close)
            browser.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            key = base64.b64encode(self.rng.randbytes(16)).decode("ascii")
            browser.sendall(
                f"GET /api/v1/signals HTTP/1.1\r\nHost: {self.address}:{HTTP_PORT}\r\n"
                "Authorization: Bearer overload-rig-token-0123456789\r\nUpgrade: websocket\r\n"
                f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode("ascii")
            )
            assert b" 101 " in browser.recv(1024), "the server takes no WebSocket"
            text = b'{"signals": ["*.axis0.*"], "period": "1ms", "events": true}'
            browser.sendall(bytes([0x81, 0x80 | len(text)]) + bytes(4) + text)


class UnreadTerminal(Case):
    """A program writes commands into a pseudo-terminal until that is full, and reads no reply."""

    def rack(self):
        return super().rack() + (
            f'[[device]]\ntype = "tmcm-142"\nname = "module"\nrs485 = "pty:{self.directory}/line"\n'
        )

    def stall(self, process):
        terminal = os.open(self.directory / "line", os.O_RDWR | os.O_NONBLOCK | os.O_NOCTTY)
        self.open.callback(os.close, terminal)
        end = time.monotonic() + STALL
        while time.monotonic() < end:
            with contextlib.suppress(BlockingIOError):
                os.write(terminal, bytes([1, 6, 1, 0, 0, 0, 0, 0, 8]) * 20)


class UnreadAdapter(Case):
    """The same for a CAN adapter, on which another program talks."""

    def rack(self):
        return (
            super().rack()
            + BUS.format(ports=f'"slcan:{self.directory}/can", "slcan-tcp:{self.address}:{CAN_PORT}"')
            + '[[bus.device]]\ntype = "tmcm-142"\nname = "module"\n'
        )

    def stall(self, process):
        terminal = os.open(self.directory / "can", os.O_RDWR | os.O_NONBLOCK | os.O_NOCTTY)
        self.open.callback(os.close, terminal)
        os.write(terminal, b"O\r")
        with socket.create_connection((self.address, CAN_PORT)) as other:
            other.sendall(b"O\r")
            other.setblocking(False)
            end = time.monotonic() + STALL
            while time.monotonic() < end:
                with contextlib.suppress(BlockingIOError):
                    other.sendall(b"t001706010000000000\r" * 20)
                with contextlib.suppress(BlockingIOError):
                    other.recv(65536)


CASES = {
    "300 TMC8670": ManyDrives,
    "127 TMCC160": ManyNodes,
    "400 TMCM-142": ManyModules,
    "stderr": UnreadErrors,
    "stdout": UnreadOutput,
    "fifo csv": FifoTable,
    "fifo capture": FifoCapture,
    "fifo session": FifoSession,
    "disk csv": StallingTable,
    "disk capture": StallingCapture,
    "disk session": StallingSession,
    "disk state": StallingState,
    "web stream": UnreadStream,
    "serial pty": UnreadTerminal,
    "can pty": UnreadAdapter,
}


class Result:
    """`end` and `second`: seconds to the end after the first and the second SIGINT, or None."""

    def __init__(self):
        self.gap = self.end = self.second = None
        self.refused = ""


def try_case(program, kind, rng, twice):
    result = Result()
    with tempfile.TemporaryDirectory(prefix="stator-rig-") as directory:
        case = kind(own_address(), directory, rng)
        try:
            path = pathlib.Path(directory) / "rack.toml"
            path.write_text(case.rack(), encoding="ascii")
            with RackProcess(program, str(path), directory, *case.options(), patience=NEVER, **case.popen) as process:
                watch = Watch(case.address, case.refused) if case.watched else None
                if watch:
                    watch.start()
                    time.sleep(0.2)
                stalled = time.monotonic()
                case.stall(process)
                time.sleep(max(0.0, STALL - (time.monotonic() - stalled)) + rng.uniform(0, 0.5))
                if watch:
                    result.gap = watch.end()
                interrupt(process.process, rng, twice, result)
                process.process.kill()
                case.close()  # who waits for a disk cannot be killed before
        except NotStarted as error:
            result.refused = str(error)
        except Silent:
            result.gap = NEVER  # it does not even start
        finally:
            case.close()
    return result


def interrupt(process, rng, twice, result):
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    if twice:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(rng.uniform(0.02, 0.3))
        if process.returncode is None:
            begin = time.monotonic()
            process.send_signal(signal.SIGINT)
            result.second = NEVER
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(NEVER)
    seconds = time.monotonic() - begin if process.returncode is not None else NEVER
    if result.second is None:
        result.end = seconds
    else:
        result.second = seconds


def worst(values):
    values = [each for each in values if each is not None]
    return max(values) if values else None


def show(value):
    return f"{'-' if value is None else 'never' if value >= NEVER else f'{value:.3f}':>12}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stator", required=True)
    parser.add_argument("--count", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--limit", type=float, default=1.0)
    parser.add_argument("--factor", type=float, default=5.0)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    names = [name for name in CASES if not options.only or any(part in name for part in options.only)]
    if options.list or not names:
        print("\n".join(names))
        return 0 if names else 2
    have_own_mounts()
    allowed = options.limit * options.factor
    failed = 0
    print(
        f"{'worst of ' + str(options.count) + ', s':14}"
        + "".join(f"{column:>12}" for column in ("no answer", "SIGINT", "the second"))
    )
    for name in names:
        results = [
            try_case(options.stator, CASES[name], random.Random(f"{options.seed}/{name}/{number}"), number % 2 == 1)
            for number in range(options.count)
        ]
        values = [worst(getattr(each, what) for each in results) for what in ("gap", "end", "second")]
        late = any(value is not None and value > allowed for value in values)
        failed += late
        refused = next((each.refused for each in results if each.refused), "")
        print(
            f"{name:14}"
            + "".join(map(show, values))
            + ("  TOO LATE" if late else "")
            + (f"  refused: {refused}" if refused else ""),
            flush=True,
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
