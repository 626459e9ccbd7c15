#!/usr/bin/python3
"""can-utils, unmodified as Debian has them, as somebody who turns a TMCC160 by hand: candump shows what the
drive says to cansend, canplayer and cangen.

    can_utils_drive.py --stator PROGRAM [UNITTEST OPTION...]
    can_utils_drive.py --stator PROGRAM --interface vcan0 [UNITTEST OPTION...]

PROGRAM is `stator`. The programs run behind "stator can-exec", or with --interface on that interface of a
kernel that has CAN.
"""

import argparse
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

from racks import DRIVE_NODE as NODE, drive_rack
from running_rack import PATIENCE, RunningRack, unavailable, wait_until

OPTIONS = argparse.Namespace(stator=None, interface=None)
BUS = f"utils{os.getpid()}"


def tool(*words):
    """The command line of a program that reaches the bus."""
    return list(words) if OPTIONS.interface else [OPTIONS.stator, "can-exec", "--bus", BUS, "--", *words]


def run(*words):
    done = subprocess.run(tool(*words), text=True, capture_output=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, f"{' '.join(words)}: {done.stderr}"
    return done.stdout


class Dump:
    """candump -L, once it hears the bus."""

    def __init__(self):
        self.process = subprocess.Popen(
            tool("candump", "-L", BUS), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        self.frames = []
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()
        wait_until(
            lambda: run("cansend", BUS, "7F0#") is not None and "7F0#" in self.frames,
            "candump hears the bus",
            pause=0.1,
        )

    def _read(self):
        for line in self.process.stdout:
            self.frames.append(line.split()[-1])

    def wait_for(self, frame, since=0):
        """The first frame from number `since` on that matches as a whole."""
        return wait_until(
            lambda: next((each for each in self.frames[since:] if re.fullmatch(frame, each)), None),
            f"candump shows {frame}",
        )

    def end(self):
        """What is left to say when its process ends; it is given no reason if it did by itself."""
        if self.process.poll() is None:
            self.process.terminate()
        self.process.wait(PATIENCE)
        self.thread.join(PATIENCE)
        self.process.stdout.close()


class Drive(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="stator-client-")
        self.addCleanup(directory.cleanup)
        self.log = os.path.join(directory.name, "bus.log")
        self.commands = os.path.join(directory.name, "commands.log")
        port = f"socketcan:{OPTIONS.interface}" if OPTIONS.interface else f"can-exec:{BUS}"
        self.rack = self.enterContext(RunningRack(OPTIONS.stator, drive_rack(port, f'log = "{self.log}"', 1000)))
        self.dump = Dump()
        self.addCleanup(lambda: self.dump.end())

    def ask(self, frame, answer):
        since = len(self.dump.frames)
        run("cansend", BUS, frame)
        return self.dump.wait_for(answer, since)

    def write(self, index, subindex, value, size):
        request = struct.pack("<BHB", 0x23 | (4 - size) << 2, index, subindex)
        request += (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")
        self.ask(f"{0x600 + NODE:03X}#{request.hex().upper()}", f"585#60{request[1:4].hex().upper()}00000000")

    def read(self, index, subindex=0):
        request = struct.pack("<BHB4x", 0x40, index, subindex)
        answer = self.ask(f"{0x600 + NODE:03X}#{request.hex().upper()}", f"585#4[37BF]{request[1:4].hex().upper()}.*")
        data = bytes.fromhex(answer.split("#")[1])
        return int.from_bytes(data[4 : 8 - (data[0] >> 2 & 3)], "little", signed=True)

    def start(self):
        self.ask("000#8105", "705#00")
        self.ask("000#0105", "185#.*")
        self.dump.wait_for("705#05", len(self.dump.frames))

    def turn(self):
        for entry in ((0x6060, 0, 3, 1), (0x2020, 3, 20000, 4), (0x6083, 0, 10000, 4), (0x6084, 0, 10000, 4)):
            self.write(*entry)
        for controlword in (6, 7, 15):
            self.write(0x6040, 0, controlword, 2)
        wait_until(lambda: self.read(0x6041) & 0x6F == 0x27, "operation enabled")
        for speed in (1200, 0):
            self.write(0x60FF, 0, speed, 4)
            wait_until(lambda: abs(self.read(0x606C) - speed) < 30, f"{speed} rpm")

    def test_it_turns_and_refuses(self):
        self.start()
        self.ask("605#4008100000000000", "585#4108100007000000")
        self.ask("605#6000000000000000", "585#01" + b"TMCC160".hex().upper())
        for request, code in (
            ("2B41600000000000", "06010002"),
            ("40FF5F0000000000", "06020000"),
            ("4018100900000000", "06090011"),
            ("2F60600007000000", "06090030"),
            ("A008100000000000", "05040001"),
        ):
            self.ask(f"605#{request}", f"585#80{request[2:8]}{bytes.fromhex(code)[::-1].hex().upper()}")
        self.turn()
        self.ask("305#06", "085#1082.*")  # an RPDO with half its bytes: emergency 8210h
        self.rack.stop()
        self.assertRegex(self.rack.log(), " 0 dropped, 0 malformed")

    def test_it_loses_its_supply_and_comes_back(self):
        self.start()
        with self.rack.fault("power-off", "drive"):
            # What was on its way is still shown; then candump's time of silence runs out.
            wait_until(lambda: run("candump", "-L", "-T", "2000", f"{BUS},700:780") == "", "silence")
            since = len(self.dump.frames)
            run("cansend", BUS, "605#4000100000000000")
            self.assertEqual(run("candump", "-L", "-T", "1000", f"{BUS},580:780"), "")
        self.dump.wait_for("705#00", since)
        self.start()
        self.turn()

    def test_canplayer_repeats_a_session(self):
        """What canplayer sends of a log gets the answers that the log has."""
        requests = ["605#4000100000000000", "605#2F60600003000000", "605#4060600000000000", "605#2B41600000000000"]
        answers = ["585#430010009201FCFF", "585#6060600000000000", "585#4F60600003000000", "585#8041600002000106"]
        with open(self.commands, "w", encoding="ascii") as file:
            for number, request in enumerate(requests):
                file.write(f"({number / 10:.6f}) {BUS} {request}\n")
        self.start()
        since = len(self.dump.frames)
        run("canplayer", "-I", self.commands, f"{BUS}={BUS}")
        self.dump.wait_for(re.escape(answers[-1]), since)
        heard = [frame for frame in self.dump.frames[since:] if frame.startswith("585#")]
        self.assertEqual(heard, answers)

    def test_cangen_loses_nothing(self):
        self.start()
        since = len(self.dump.frames)
        run("cangen", BUS, "-g", "0", "-n", "2000", "-I", "7E0", "-L", "8", "-D", "i", "-p", "10")
        wait_until(lambda: sum(frame.startswith("7E0#") for frame in self.dump.frames[since:]) == 2000, "2000 frames")
        numbers = [
            int.from_bytes(bytes.fromhex(frame[4:]), "little")
            for frame in self.dump.frames[since:]
            if frame.startswith("7E0#")
        ]
        self.assertEqual(numbers, list(range(2000)))
        self.assertEqual(self.read(0x1000) & 0xFFFFFFFF, 0xFFFC0192)
        self.rack.stop()
        with open(self.log, encoding="ascii") as file:
            self.assertEqual(sum(" 7E0#" in line for line in file), 2000)

    def test_a_rack_that_was_killed_is_found_again(self):
        self.start()
        self.rack.kill()
        if OPTIONS.interface is None:
            wait_until(lambda: self.dump.process.poll() is not None, "candump ends with its bus")
        self.dump.end()
        self.rack.start()
        self.dump = Dump()
        self.start()
        self.turn()


def main():
    global BUS
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    parser.add_argument("--interface")
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    BUS = OPTIONS.interface or BUS
    for program in ("candump", "cansend", "canplayer", "cangen"):
        if shutil.which(program) is None:
            unavailable(f"{program} is missing", "scripts/setup clients installs can-utils")
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
