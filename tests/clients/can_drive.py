#!/usr/bin/python3
"""One session with a TMCC160 over every kind of CAN port, by Debian's python-can: what comes back must
be the same on each.

    can_drive.py --stator PROGRAM --library LIBRARY [UNITTEST OPTION...]
    can_drive.py --stator PROGRAM --interface vcan0 [UNITTEST OPTION...]

PROGRAM is `stator`, LIBRARY what "stator can-exec" preloads. With --interface the port is SocketCAN on
that interface of a kernel that has CAN, beside the ports that need nothing of the kernel.
"""

import argparse
import os
import re
import struct
import sys
import tempfile
import time
import unittest

from can_transports import can, enter_surroundings
from racks import DRIVE_NODE as NODE, drive_rack
from running_rack import RunningRack, free_port

OPTIONS = argparse.Namespace(stator=None, library=None, interface=None)
TIMEOUT = 20.0
BUS = "drivetest0"


class Abort(Exception):
    pass


class Session:
    """What a master does to the drive, and what it notes of the answers."""

    def __init__(self, bus):
        self.bus = bus
        self.notes = []

    def receive(self, wanted, timeout=TIMEOUT):
        """The next frame with that identifier."""
        end = time.monotonic() + timeout
        while (left := end - time.monotonic()) > 0:
            message = self.bus.recv(left)
            if message is not None and message.arbitration_id == wanted:
                return bytes(message.data)
        raise TimeoutError(f"no frame with identifier {wanted:03X}h")

    def send(self, identifier, data):
        self.bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False), timeout=TIMEOUT)

    def request(self, data):
        self.send(0x600 + NODE, data)
        answer = self.receive(0x580 + NODE)
        if answer[0] == 0x80:
            raise Abort(f"{struct.unpack('<I', answer[4:])[0]:08X}")
        return answer

    def read(self, index, subindex=0, signed=False):
        answer = self.request(struct.pack("<BHB4x", 0x40, index, subindex))
        if answer[0] & 2:
            return int.from_bytes(answer[4 : 4 + 4 - (answer[0] >> 2 & 3)], "little", signed=signed)
        data, toggle = b"", 0
        while True:
            answer = self.request(bytes([0x60 | toggle]) + bytes(7))
            data += answer[1 : 8 - (answer[0] >> 1 & 7)]
            toggle ^= 0x10
            if answer[0] & 1:
                return data

    def write(self, index, subindex, value, size):
        self.request(
            struct.pack("<BHB", 0x23 | (4 - size) << 2, index, subindex)
            + (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")
        )

    def note(self, *what):
        self.notes.append(" ".join(str(part) for part in what))

    def note_refusal(self, name, action, *arguments):
        try:
            action(*arguments)
            self.note(name, "was not refused")
        except Abort as abort:
            self.note(name, "refused:", abort)

    def until(self, name, condition):
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            if condition():
                self.note(name)
                return
        self.note(name, "never came")

    def status(self):
        return self.read(0x6041)

    def enable(self):
        for controlword in (6, 7, 15):
            self.write(0x6040, 0, controlword, 2)
        self.until("enabled", lambda: self.status() & 0x6F == 0x27)

    def run(self):
        self.send(0, [129, NODE])
        self.note("boot-up", self.receive(0x700 + NODE).hex())
        self.note("device type", hex(self.read(0x1000)), "name", self.read(0x1008).decode())
        text = self.read(0x1021)
        self.note("data sheet of", len(text), "bytes,", len(re.findall(rb"ParameterName", text)), "names")
        self.note_refusal("write to 1000h", self.write, 0x1000, 0, 1, 4)
        self.note_refusal("mode 7", self.write, 0x6060, 0, 7, 1)
        self.note_refusal("object 1004h", self.read, 0x1004)
        self.note_refusal("block transfer", self.request, struct.pack("<BHB4x", 0xA0, 0x1008, 0))
        self.process_data()
        self.motion()
        self.fault()
        return self.notes

    def process_data(self):
        self.write(0x1800, 1, 0xC0000180 + NODE, 4)
        self.write(0x1800, 2, 1, 1)
        self.write(0x1A00, 0, 0, 1)
        self.write(0x1A00, 1, 0x60410010, 4)
        self.write(0x1A00, 2, 0x60610008, 4)
        self.write(0x1A00, 0, 2, 1)
        self.write(0x1800, 1, 0x40000180 + NODE, 4)
        self.send(0, [1, NODE])
        self.write(0x1017, 0, 20, 2)
        self.note("heartbeat", self.receive(0x700 + NODE).hex())
        for _ in range(3):
            self.send(0x80, b"")
            self.note("with SYNC", self.receive(0x180 + NODE).hex())

    def motion(self):
        self.write(0x6060, 0, 3, 1)
        self.write(0x2020, 3, 20000, 4)
        self.write(0x6083, 0, 10000, 4)
        self.write(0x6084, 0, 10000, 4)
        self.enable()
        self.write(0x60FF, 0, 1200, 4)
        self.until("1200 rpm", lambda: abs(self.read(0x606C, signed=True) - 1200) < 30 and self.status() & 0x400)
        self.write(0x60FF, 0, 0, 4)
        self.until("stands", lambda: not self.status() & 0x4000)
        self.write(0x6060, 0, 6, 1)
        self.write(0x6098, 0, 17, 1)
        self.write(0x6099, 1, 600, 4)
        self.write(0x6099, 2, 150, 4)
        self.until("homing mode", lambda: self.read(0x6061) == 6)
        self.write(0x6040, 0, 0x1F, 2)
        self.until("home found", lambda: self.status() & 0x3400 == 0x1400)
        self.write(0x6040, 0, 0x0F, 2)
        self.write(0x6060, 0, 1, 1)
        self.until("position mode", lambda: self.read(0x6061) == 1)
        self.write(0x607A, 0, 240, 4)
        self.write(0x6040, 0, 0x1F, 2)
        self.write(0x6040, 0, 0x0F, 2)
        self.until("ten turns", lambda: abs(self.read(0x6064, signed=True) - 240) < 3)

    def fault(self):
        self.send(0, [2, NODE])
        self.send(0, [1, NODE])
        self.until("fault after NMT stop", lambda: self.status() & 0x4F == 8)
        self.write(0x6040, 0, 0, 2)
        self.send(0x200 + NODE, [0x80, 0])
        self.note("emergency", self.receive(0x80 + NODE).hex())
        self.until("fault reset", lambda: self.status() & 0x4F == 0x40)


class Transports(unittest.TestCase):
    maxDiff = None
    expected = None

    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)

    def session(self, link, **bus):
        """Runs the drive behind `link` and the session over python-can's `bus`."""
        with RunningRack(OPTIONS.stator, drive_rack(link)):
            connection = can.Bus(**bus)
            try:
                notes = Session(connection).run()
            finally:
                connection.shutdown()
        self.assertNotIn("never came", "\n".join(notes), "\n".join(notes))
        self.assertNotIn("was not refused", "\n".join(notes), "\n".join(notes))
        if Transports.expected is None:
            Transports.expected = notes
        self.assertEqual(notes, Transports.expected)

    def test_socketcand(self):
        port = free_port()
        self.session(f"socketcand:{port}", interface="socketcand", host="127.0.0.1", port=port, channel="can0")

    def test_slcan_on_a_terminal(self):
        path = os.path.join(self.directory.name, "can0")
        self.session(f"slcan:{path}", interface="slcan", channel=path, sleep_after_open=0.1)

    def test_slcan_over_tcp(self):
        port = free_port()
        self.session(f"slcan-tcp:{port}", interface="slcan", channel=f"socket://127.0.0.1:{port}", sleep_after_open=0.1)

    def test_udp_multicast(self):
        if "STATOR_TEST_NETWORK" not in os.environ:
            self.skipTest("needs a network namespace (root)")
        self.session("udp-multicast:", interface="udp_multicast", channel="239.74.163.2")

    def test_can_exec(self):
        if OPTIONS.library is None:
            self.skipTest("--library is not given")
        self.session(f"can-exec:{BUS}", interface="socketcan", channel=BUS)

    def test_socketcan(self):
        if OPTIONS.interface is None:
            self.skipTest("no interface of a kernel with CAN is named; scripts/can-vm has one")
        self.session(f"socketcan:{OPTIONS.interface}", interface="socketcan", channel=OPTIONS.interface)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--library")
    what.add_argument("--interface")
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    if OPTIONS.library is not None:
        enter_surroundings(OPTIONS.library, BUS)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
