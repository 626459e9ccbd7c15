#!/usr/bin/python3
"""Hosts of two TMCM-142 modules on one line and on one bus, by Debian's pyserial and python-can: what
comes back must be the same over a pseudo-terminal, TCP and every kind of CAN port.

    tmcl_module.py --stator PROGRAM --library LIBRARY [UNITTEST OPTION...]
    tmcl_module.py --stator PROGRAM --interface vcan0 [UNITTEST OPTION...]

PROGRAM is `stator`, LIBRARY what "stator can-exec" preloads. With --interface one port is SocketCAN on
that interface of a kernel that has CAN.
"""

import argparse
import os
import struct
import sys
import tempfile
import time
import unittest

from can_transports import can, enter_surroundings, serial
from running_rack import RunningRack, free_port

OPTIONS = argparse.Namespace(stator=None, library=None, interface=None)
TIMEOUT = 20.0
SILENCE = 0.2  # s
PAUSE = 0.3  # s; after 5 ms a part of a telegram is forgotten
BUS = "tmcltest0"
FIRST, SECOND, HOST = 1, 3, 2
BUS_OF_PORT = """
[[bus]]
bit_rate = "unlimited"
ports = ["{port}"]
"""
DEVICE = """
[[{table}]]
type = "tmcm-142"
name = "module{address}"
address = {address}
can_id = {address}
{line}

[{table}.axis]
left_switch = {{ pressed_to = -1.5 }}
"""

# Commands of TMCL.
ROR, MST, MVP, SAP, GAP, STAP, RSAP, SGP, GGP = 1, 3, 4, 5, 6, 7, 8, 9, 10
RFS, SIO, GIO, CALC, COMP, JC, WAIT, STOP, AGP = 13, 14, 15, 19, 20, 21, 27, 28, 35
STOP_PROGRAM, RUN_PROGRAM, STEP_PROGRAM, RESET_PROGRAM = 128, 129, 130, 131
START_DOWNLOAD, QUIT_DOWNLOAD, READ_MEMORY, PROGRAM_STATUS = 132, 133, 134, 135
VERSION, TARGET_EVENT, ENTER_ASCII = 136, 138, 139

# Three journeys there and back, counted in user variable 0.
PROGRAM = [
    (SGP, 0, 2, 0),
    (MVP, 0, 0, 70_000),
    (WAIT, 1, 0, 0),
    (MVP, 0, 0, 50_000),
    (WAIT, 1, 0, 0),
    (GGP, 0, 2, 0),
    (CALC, 0, 0, 1),
    (AGP, 0, 2, 0),
    (COMP, 0, 0, 3),
    (JC, 6, 0, 1),
    (SIO, 1, 2, 1),
    (STOP, 0, 0, 0),
]


def telegram(module, command, type_=0, motor=0, value=0):
    body = struct.pack(">BBBBi", module, command, type_, motor, value)
    return body + bytes([sum(body) & 0xFF])


class SerialHost:
    """At the end of a serial line; `answer` gives the seven bytes that follow the module's address."""

    name = "a serial line"

    def __init__(self, url):
        self.port = serial.serial_for_url(url, timeout=TIMEOUT)

    def send(self, module, *command):
        self.port.write(telegram(module, *command))

    def answer(self, module):
        data = self.port.read(9)
        if len(data) != 9:
            raise TimeoutError(f"{len(data)} of 9 bytes came")
        if data[:2] != bytes([HOST, module]) or sum(data[:8]) & 0xFF != data[8]:
            raise ValueError(f"no reply of module {module}: {data.hex(' ')}")
        return data[2:8]

    def block(self, module, *command):
        """The reply to a command that is answered with eight bytes of its own kind."""
        self.send(module, *command)
        data = self.port.read(9)
        if data[:1] != bytes([HOST]):
            raise ValueError(f"no reply: {data.hex(' ')}")
        return data[1:]

    def silence(self):
        before, self.port.timeout = self.port.timeout, SILENCE
        data = self.port.read(100)
        self.port.timeout = before
        return data

    def close(self):
        self.port.close()


class CanHost:
    name = "a bus"

    def __init__(self, **bus):
        self.bus = can.Bus(**bus)

    def send(self, module, *command):
        self.bus.send(
            can.Message(arbitration_id=module, data=telegram(module, *command)[1:], is_extended_id=False),
            timeout=TIMEOUT,
        )

    def receive(self, timeout=TIMEOUT):
        end = time.monotonic() + timeout
        while (left := end - time.monotonic()) > 0:
            message = self.bus.recv(left)
            if message is not None and message.arbitration_id == HOST:
                return bytes(message.data)
        return b""

    def answer(self, module):
        data = self.receive()
        if len(data) != 8 or data[0] != module:
            raise ValueError(f"no reply of module {module}: {data.hex(' ')}")
        return data[1:7]

    def block(self, module, *command):
        self.send(module, *command)
        return self.receive()

    def silence(self):
        return self.receive(SILENCE)

    def close(self):
        self.bus.shutdown()


class Session:
    """What a host does to a module, and what it notes of the answers."""

    def __init__(self, host, module):
        self.host = host
        self.module = module
        self.notes = []

    def ask(self, command, type_=0, motor=0, value=0):
        """Status and value."""
        self.host.send(self.module, command, type_, motor, value)
        return self.reply(command)

    def reply(self, command):
        status, echoed, value = struct.unpack(">BBi", self.host.answer(self.module))
        if echoed != command:
            raise ValueError(f"command {echoed} is answered instead of {command}")
        return status, value

    def note(self, *what):
        self.notes.append(" ".join(str(part) for part in what))

    def note_answers(self, name, *commands):
        self.note(name, [self.ask(*command) for command in commands])

    def until(self, name, condition):
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            if condition():
                self.note(name)
                return
        self.note(name, "never came")

    def parameter(self, number):
        return self.ask(GAP, number)[1]

    def run(self):
        self.note("version", self.host.block(self.module, VERSION).decode("ascii"), self.ask(VERSION, 1))
        self.note_answers(
            "refused",
            (255,),
            (SAP, 24),
            (SAP, 8, 0, 1),
            (SAP, 6, 0, 16),
            (SAP, 6, 1, 1),
            (GGP, 0, 1),
            (COMP,),
            (GIO, 9),
            (SIO, 3, 2, 1),
        )
        self.parameters()
        self.motion()
        self.search()
        self.program()
        return self.notes

    def parameters(self):
        self.note_answers("current", (SAP, 6, 0, 11), (STAP, 6), (SAP, 6, 0, 3), (GAP, 6), (RSAP, 6), (GAP, 6))
        self.note_answers(
            "locked", (SGP, 73, 0, 1234), (STAP, 6), (SGP, 77, 0, 1), (GGP, 73), (SGP, 73, 0, 4321), (STAP, 6)
        )
        self.note_answers("variable", (SGP, 55, 2, -123456), (GGP, 55, 2))
        self.note_answers("outputs", (SIO, 0, 2, 1), (GIO, 0, 2), (SIO, 255, 2, 0), (GIO, 0, 2))

    def motion(self):
        self.note_answers("ramp", (SAP, 4, 0, 60_000_000), (SAP, 5, 0, 2_000_000))
        self.note_answers("turns", (ROR, 0, 0, 10_000_000))
        self.until("at its speed", lambda: self.parameter(3) == 10_000_000)
        self.note_answers("stops", (MST,))
        self.until("stands", lambda: self.parameter(3) == 0)
        self.note_answers("starts", (SAP, 1, 0, 0), (MVP, 0, 0, 100_000))
        self.note_answers("asks for the event", (TARGET_EVENT, 0, 0, 1))
        self.note("event", self.reply(TARGET_EVENT))
        self.note_answers("there", (GAP, 8), (GAP, 1), (GAP, 3))
        self.note_answers("back", (MVP, 1, 0, -100_000))
        self.until("back again", lambda: self.parameter(8) == 1 and self.parameter(1) == 0)

    def search(self):
        self.note_answers("search", (SAP, 194, 0, 20_000_000), (SAP, 195, 0, 8_000_000), (RFS, 0))
        self.until("is on", lambda: self.ask(RFS, 2)[1] > 0)
        self.until("is over", lambda: self.ask(RFS, 2)[1] == 0)
        self.note("near the switch", abs(self.parameter(1)) < 20_000)
        self.note_answers("away from it", (MVP, 0, 0, 50_000))
        self.until("off the switch", lambda: self.parameter(8) == 1 and self.parameter(11) == 0)

    def program(self):
        self.note_answers("download", (START_DOWNLOAD,), *PROGRAM, (QUIT_DOWNLOAD,))
        memory = [self.host.block(self.module, READ_MEMORY, 0, 0, at)[:7] for at in range(len(PROGRAM))]
        self.note("read back", memory == [struct.pack(">BBBi", *each) for each in PROGRAM])
        self.note_answers("runs", (RUN_PROGRAM, 1))
        self.until("ends", lambda: self.ask(PROGRAM_STATUS)[1] == 0)
        self.note_answers("has counted", (GGP, 0, 2), (GIO, 1, 2), (GAP, 1))
        self.note_answers("reset", (RESET_PROGRAM,), (GGP, 130), (STEP_PROGRAM,))
        self.until("one step", lambda: self.ask(GGP, 130)[1] == 1)
        self.note_answers("ended", (STOP_PROGRAM,), (PROGRAM_STATUS,))


class Modules(unittest.TestCase):
    maxDiff = None
    expected = None

    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)

    def start(self, line=None, port=None):
        """Runs two modules behind a serial line or a port of their bus."""
        rack = "" if port is None else BUS_OF_PORT.format(port=port)
        for address in (FIRST, SECOND):
            rack += DEVICE.format(
                table="device" if port is None else "bus.device",
                address=address,
                line="" if line is None else f'rs485 = "{line}"',
            )
        self.enterContext(RunningRack(OPTIONS.stator, rack))

    def session(self, host):
        """One session with each module: the same notes everywhere, and what one is told leaves the
        other alone."""
        try:
            for module in (FIRST, SECOND):
                notes = Session(host, module).run()
                self.assertNotIn("never came", "\n".join(notes), "\n".join(notes))
                if Modules.expected is None:
                    Modules.expected = notes
                self.assertEqual(notes, Modules.expected, f"over {host.name}, module {module}")
                other = Session(host, FIRST + SECOND - module)
                self.assertEqual(other.ask(GAP, 4)[1], 500_000 if module == FIRST else 60_000_000)
        finally:
            host.close()

    def terminal(self):
        path = os.path.join(self.directory.name, "line")
        self.start(line=f"pty:{path}")
        host = SerialHost(path)
        self.addCleanup(host.close)
        return host

    def test_terminal(self):
        self.session(self.terminal())

    def test_tcp(self):
        port = free_port()
        self.start(line=f"tcp:{port}")
        self.session(SerialHost(f"socket://127.0.0.1:{port}"))

    def test_slcan(self):
        path = os.path.join(self.directory.name, "can0")
        self.start(port=f"slcan:{path}")
        self.session(CanHost(interface="slcan", channel=path, sleep_after_open=0.1))

    def test_socketcand(self):
        port = free_port()
        self.start(port=f"socketcand:{port}")
        self.session(CanHost(interface="socketcand", host="127.0.0.1", port=port, channel="can0"))

    def test_can_exec(self):
        if OPTIONS.library is None:
            self.skipTest("--library is not given")
        self.start(port=f"can-exec:{BUS}")
        self.session(CanHost(interface="socketcan", channel=BUS))

    def test_socketcan(self):
        if OPTIONS.interface is None:
            self.skipTest("no interface of a kernel with CAN is named; scripts/can-vm has one")
        self.start(port=f"socketcan:{OPTIONS.interface}")
        self.session(CanHost(interface="socketcan", channel=OPTIONS.interface))

    def test_a_disturbed_line(self):
        host = self.terminal()
        good = telegram(FIRST, GAP, 6)
        wrong = good[:8] + bytes([good[8] ^ 1])
        answer = struct.pack(">BBBBi", HOST, FIRST, 100, GAP, 8)
        answer += bytes([sum(answer) & 0xFF])
        host.port.write(wrong)
        self.assertEqual(host.answer(FIRST)[:2], bytes([1, GAP]), "a wrong sum is told")
        for length in range(1, 9):
            self.assertEqual(self.after_a_part(host, good, length), answer, f"after a part of {length} bytes")
        host.port.write(bytes(range(0x90, 0x95)))
        time.sleep(PAUSE)
        self.assertEqual(self.byte_by_byte(host, good), answer, "byte by byte after noise")
        for module in (0, 2, 255):
            host.send(module, GAP, 6)
        self.assertEqual(host.silence(), b"", "nobody has these addresses")
        host.send(SECOND, SGP, 66, 0, 77)
        self.assertEqual(host.answer(SECOND)[0], 100, "answered with the old address")
        host.send(77, GGP, 66)
        self.assertEqual(host.answer(77)[0], 100, "reached at the new one")

    @staticmethod
    def after_a_part(host, data, length):
        """The answer behind a part of a telegram that is forgotten; again if the program was held up for the whole pause,
        so that it has read both at once."""
        answer = b""
        for _ in range(20):
            host.port.write(data[:length])
            time.sleep(PAUSE)
            host.port.write(data)
            answer = host.port.read(9)
            if len(answer) == 9 and answer[2] == 100:
                return answer
            host.silence()
        return answer

    @staticmethod
    def byte_by_byte(host, data):
        """The answer; again if this program was held up for so long that the parts were forgotten. A module that was held
        up itself answers each try, all at once."""
        for _ in range(20):
            for byte in data:
                host.port.write(bytes([byte]))
            if answer := host.silence():
                return answer[:9]
        return b""

    def test_lines_of_text(self):
        host = self.terminal()

        def line(text, ends=2):
            """What comes back, up to so many ends of lines."""
            host.port.write(text.encode("ascii") + b"\r")
            said = b"".join(host.port.read_until(b"\r") for _ in range(ends))
            return (said + host.silence()).decode("ascii")

        host.send(FIRST, ENTER_ASCII)
        self.assertEqual(host.answer(FIRST)[0], 100)
        self.assertEqual(line("AGAP 6, 0"), "AGAP 6, 0\rBA 100 8\r")
        self.assertEqual(line("a sap 6, 0, 9\b5"), "a sap 6, 0, 9\b5\rBA 100 5\r")
        self.assertEqual(line("AGGP 66, 0"), "AGGP 66, 0\rBA 100 1\r")
        self.assertEqual(line("ASGP 3, 2, -7"), "ASGP 3, 2, -7\rBA 100 -7\r")
        self.assertEqual(line("AFLY 1")[-7:], "BA 2 0\r", "no such command")
        self.assertEqual(line("BGAP 6, 0", ends=0), "", "the letter of nobody")
        host.send(SECOND, GAP, 6)
        self.assertEqual(host.answer(SECOND)[0], 100, "the other module is still binary")
        host.port.write(b"\r")
        host.silence()
        line("ASGP 67, 0, 32", ends=1)
        self.assertEqual(line("AGAP 6, 0", ends=1), "BA 100 5\r", "without echo")
        self.assertEqual(line("ABIN", ends=1), "BA 100 0\r")
        host.send(FIRST, GAP, 6)
        self.assertEqual(host.answer(FIRST), struct.pack(">BBi", 100, GAP, 5))


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
