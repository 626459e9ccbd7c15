#!/usr/bin/env python3
"""`stator top` at a running rack: a single frame, and in a terminal of its own with keys."""

import argparse
import fcntl
import os
import pathlib
import pty
import re
import select
import socket
import struct
import subprocess
import sys
import termios
import time

RACK = pathlib.Path(__file__).resolve().parents[2] / "racks" / "gantry.toml"
PATIENCE = 60.0  # seconds, for a busy machine


class Screen:
    """What a program has written to a terminal of a certain size."""

    def __init__(self, command, rows, columns):
        self.child, self.terminal = pty.fork()
        if self.child == 0:
            try:
                os.execv(command[0], command)
            finally:
                os._exit(127)  # the program is missing; this copy of the test must not go on
        self.resize(rows, columns)
        self.output = ""

    def resize(self, rows, columns):
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def press(self, keys):
        self.output = ""
        os.write(self.terminal, keys.encode())

    def wait_for(self, pattern):
        end = time.monotonic() + PATIENCE
        while not re.search(pattern, self.output, re.DOTALL):
            assert time.monotonic() < end, f"{pattern!r} did not come, but {self.output[-2000:]!r}"
            if select.select([self.terminal], [], [], 0.2)[0]:
                try:
                    self.output += os.read(self.terminal, 65536).decode()
                except OSError:  # the program has ended
                    assert re.search(pattern, self.output, re.DOTALL), self.output[-2000:]
        return self.output

    def status(self):
        return os.waitstatus_to_exitcode(os.waitpid(self.child, 0)[1])


def frame(text):
    """The last complete frame on the screen."""
    return text.split("\x1b[H")[-2] if text.count("\x1b[H") > 1 else text


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def check(stator, address):
    once = subprocess.run([stator, "top", "--http", address, "--once"], check=True, text=True,
                          capture_output=True, timeout=PATIENCE).stdout
    for expected in ("NETWORK", "gantry", "TMCM-3315", "gantry.axis0", "Switch on disabled", "degC",
                     "NEWEST EVENTS"):
        assert expected in once, f"{expected!r} is missing:\n{once}"
    assert "\x1b" not in once, "colours without a terminal"

    screen = Screen([stator, "top", "--http", address, "--rate", "10"], 24, 100)
    screen.wait_for(r"gantry\.axis2.*q quit.*\x1b\[H")
    screen.press("/axis1\r")
    text = frame(screen.wait_for(r"filter \(axis1\).*\x1b\[H"))
    assert "gantry.axis1" in text and "gantry.axis0" not in text, text
    screen.press("\x1bp")
    screen.wait_for(r"PAUSED.*gantry\.axis0")
    screen.press("p")
    screen.wait_for(r"\x1b\[H")
    screen.resize(12, 40)
    screen.output = ""
    text = frame(screen.wait_for(r"\x1b\[H.*\x1b\[H.*\x1b\[H"))
    assert text.count("\r\n") == 11, text
    screen.press("q")
    screen.wait_for(r"\x1b\[\?1049l")
    assert screen.status() == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--stator", required=True)
    stator = parser.parse_args().stator
    rack = subprocess.Popen([stator, "run", str(RACK), "--link", f"udp:127.0.0.1:{free_port()}",
                             "--http", "0"],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
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
    nobody = subprocess.run([stator, "top", "--once", "--http", "127.0.0.1:1"], text=True,
                            capture_output=True, check=False)
    assert nobody.returncode == 1 and "no web server" in nobody.stderr, nobody.stderr
    print("one frame and the keys work")
    return 0


if __name__ == "__main__":
    sys.exit(main())
