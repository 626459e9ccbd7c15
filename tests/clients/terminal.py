#!/usr/bin/python3
"""`stator top` at a running rack: a single frame, and in a terminal of its own with keys."""

import argparse
import fcntl
import os
import pathlib
import pty
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import termios
import time

import pyte

RACK = pathlib.Path(__file__).resolve().parents[2] / "racks" / "gantry.toml"
PATIENCE = 240.0  # seconds, for a busy machine


class Screen:
    """A terminal of a certain size, and what a program shows on it."""

    def __init__(self, command, rows, columns):
        self.child, self.terminal = pty.fork()
        if self.child == 0:
            try:
                os.execve(command[0], command, {**os.environ, "TERM": "linux"})
            finally:
                os._exit(127)  # the program is missing; this copy of the test must not go on
        self.shown = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.shown)
        self.output = b""
        self.resize(rows, columns)

    def resize(self, rows, columns):
        self.shown.resize(rows, columns)
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def press(self, keys):
        os.write(self.terminal, keys.encode())

    def text(self):
        return "\n".join(self.shown.display)

    def wait_for(self, condition):
        """Until the text on the screen is as `condition` wants it, which then is returned."""
        end = time.monotonic() + PATIENCE
        while not condition(self.text()):
            assert time.monotonic() < end, f"it did not come, but\n{self.text()}"
            if select.select([self.terminal], [], [], 0.2)[0]:
                received = os.read(self.terminal, 65536)
                self.output += received
                self.stream.feed(received)
        return self.text()

    def status(self):
        """How the program has ended; what it wrote last is read before."""
        try:
            while received := os.read(self.terminal, 65536):
                self.output += received
        except OSError:  # nobody is there any more
            pass
        return os.waitstatus_to_exitcode(os.waitpid(self.child, 0)[1])


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def check(stator, address):
    once = subprocess.run(
        [stator, "top", "--http", address, "--once"], check=True, text=True, capture_output=True, timeout=PATIENCE
    ).stdout
    for expected in ("NETWORK", "gantry", "TMCM-3315", "gantry.axis0", "Switch on disabled", "degC", "NEWEST EVENTS"):
        assert expected in once, f"{expected!r} is missing:\n{once}"
    assert "\x1b" not in once, "colours without a terminal"

    screen = Screen([stator, "top", "--http", address, "--rate", "10"], 24, 100)
    screen.wait_for(lambda text: "gantry.axis2" in text and "q quit" in text)
    screen.press("/axis1\r")
    text = screen.wait_for(lambda text: "filter (axis1)" in text)
    assert "gantry.axis1" in text and "gantry.axis0" not in text, text
    screen.press("\x1b")
    screen.wait_for(lambda text: "gantry.axis0" in text)
    screen.press("p")
    screen.wait_for(lambda text: "PAUSED" in text)
    screen.press("p")
    screen.wait_for(lambda text: "PAUSED" not in text)
    screen.resize(12, 40)
    text = screen.wait_for(lambda text: text.split("\n")[-1].startswith("q quit") and "NEWEST EVENTS" in text)
    assert len(text.split("\n")) == 12, text
    screen.press("\x1b[B")
    screen.wait_for(lambda text: "NETWORK" not in text)
    screen.press("\x1b[1~")
    screen.wait_for(lambda text: "NETWORK" in text)
    screen.press("q")
    assert screen.status() == 0

    screen = Screen([stator, "top", "--http", address, "--rate", "10"], 24, 100)
    screen.wait_for(lambda text: "q quit" in text)
    os.kill(screen.child, signal.SIGTERM)
    assert screen.status() == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stator", required=True)
    stator = parser.parse_args().stator
    rack = subprocess.Popen(
        [stator, "run", str(RACK), "--link", f"udp:127.0.0.1:{free_port()}", "--http", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        address = None
        while address is None:
            line = rack.stdout.readline()
            assert line, "the rack has ended"
            found = re.search(r"http://[0-9.]+:\d+", line)
            address = found and found.group()
        check(stator, address)
    finally:
        rack.terminate()
        rack.wait()
    nobody = subprocess.run(
        [stator, "top", "--once", "--http", "127.0.0.1:1"], text=True, capture_output=True, check=False
    )
    assert nobody.returncode == 1 and "no web server" in nobody.stderr, nobody.stderr
    print("one frame and the keys work")
    return 0


if __name__ == "__main__":
    sys.exit(main())
