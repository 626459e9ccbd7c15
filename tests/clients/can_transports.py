#!/usr/bin/python3
"""Unmodified programs on every kind of CAN port: python-can and can-utils as Debian has them.

    can_transports.py --relay PROGRAM --library LIBRARY [UNITTEST OPTION...]

PROGRAM is tests/link/can_relay, which answers each frame with the identifier plus one; LIBRARY is
what "stator can-exec" preloads.
"""

import argparse
import logging
import os
import select
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from running_rack import server_environment, unavailable

try:
    import can
    import msgpack  # noqa: F401 (udp_multicast needs it)
    import serial  # noqa: F401 (slcan needs it)
except ImportError as error:
    unavailable(str(error), "scripts/setup test installs what is needed")

BURST = 100_000
BURST_REQUEST = 0x7FE
BURST_IDENTIFIER = 0x123
TIMEOUT = 20.0

OPTIONS = argparse.Namespace(relay=None, library=None)


def frame(identifier, data=b"", **fields):
    fields.setdefault("is_extended_id", identifier > 0x7FF)
    return can.Message(arbitration_id=identifier, data=data, **fields)


def client_environment():
    """What a server runs in that reaches a bus as these tests do. With sanitizers its runtime would
    insist on being loaded before that library."""
    options = [os.environ.get("ASAN_OPTIONS"), "verify_asan_link_order=0"]
    return {**os.environ, "ASAN_OPTIONS": ":".join(option for option in options if option)}


class Relay:
    """A running can_relay; `ports` are the names under which it says it opened them."""

    def __init__(self, *arguments, environment=None):
        self.process = subprocess.Popen(
            [OPTIONS.relay, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=environment or server_environment(),
        )
        self.ports = []
        for line in self.process.stdout:
            if line == "ready\n":
                return
            self.ports.append(line.strip())
        raise RuntimeError(self.process.stderr.read())

    def stop(self):
        """What it counted, one line per port."""
        self.process.terminate()
        _, counters = self.process.communicate(timeout=TIMEOUT)
        return counters

    def tcp_port(self, index=0):
        return int(self.ports[index].rsplit(":", 1)[1])


class EchoCases:
    """What every transport must do. Subclasses have port(), open() and say what is not carried."""

    remote_frames = True
    extended_flag = True
    own_frames = False

    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.relay = Relay("--echo", "--burst", str(BURST), self.port())
        self.buses = []

    def tearDown(self):
        for bus in self.buses:
            bus.shutdown()
        counters = self.relay.stop()
        self.directory.cleanup()
        self.assertIn(" 0 dropped, 0 malformed", counters)

    def connect(self):
        bus = self.open()
        self.buses.append(bus)
        return bus

    def receive(self, bus, identifier):
        """The next frame with `identifier`."""
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            message = bus.recv(1.0)
            if message is not None and message.arbitration_id == identifier:
                return message
        return self.fail(f"no frame with identifier {identifier:X}h came")

    def test_data_frames_of_every_length_pass_both_ways(self):
        bus = self.connect()
        for length in range(9):
            data = bytes(range(0xF8, 0xF8 + length))
            bus.send(frame(0x180 + 2 * length, data))
            answer = self.receive(bus, 0x181 + 2 * length)
            self.assertEqual(bytes(answer.data), data)
            self.assertEqual(answer.dlc, length)
            self.assertFalse(answer.is_remote_frame)
            self.assertEqual(answer.is_extended_id, not self.extended_flag)

    def test_extended_identifiers_pass_both_ways(self):
        bus = self.connect()
        bus.send(frame(0x1ABCDEF0, b"\x01"))
        answer = self.receive(bus, 0x1ABCDEF1)
        self.assertTrue(answer.is_extended_id)

    def test_remote_frames_pass_both_ways(self):
        if not self.remote_frames:
            self.skipTest("the protocol has none")
        bus = self.connect()
        bus.send(frame(0x701, is_remote_frame=True, dlc=0))
        self.assertTrue(self.receive(bus, 0x702).is_remote_frame)
        bus.send(frame(0x181, is_remote_frame=True, dlc=8))
        answer = self.receive(bus, 0x182)
        self.assertTrue(answer.is_remote_frame)
        self.assertEqual(answer.dlc, 8)

    def test_nobody_hears_own_frames(self):
        if self.own_frames:
            self.skipTest("this interface of python-can always hears them")
        bus = self.connect()
        bus.send(frame(0x300))
        first = bus.recv(TIMEOUT)
        self.assertEqual(first.arbitration_id, 0x301)


class StreamCases(EchoCases):
    """Transports that lose nothing."""

    def test_a_burst_from_the_bus_is_not_lost(self):
        bus = self.connect()
        bus.send(frame(BURST_REQUEST))
        for i in range(self.client_burst):
            message = bus.recv(TIMEOUT)
            self.assertIsNotNone(message, f"only {i} frames came")
            self.assertEqual(int.from_bytes(message.data[:4], "little"), i)

    client_burst = BURST

    def test_a_burst_to_the_bus_is_not_lost_nor_its_answers(self):
        bus = self.connect()
        for i in range(self.client_burst):
            bus.send(frame(0x200, i.to_bytes(8, "little")), timeout=TIMEOUT)
        for i in range(self.client_burst):
            message = bus.recv(TIMEOUT)
            self.assertIsNotNone(message, f"only {i} answers came")
            self.assertEqual(int.from_bytes(message.data, "little"), i)


class SharedCases(StreamCases):
    """Transports to whose port several programs connect."""

    def test_programs_of_one_port_hear_each_other(self):
        one, other = self.connect(), self.connect()
        one.send(frame(0x10, b"\x2a"))
        self.assertEqual(bytes(self.receive(other, 0x10).data), b"\x2a")


class SlcanOnPseudoTerminal(StreamCases, unittest.TestCase):
    client_burst = 5_000  # this client reads byte by byte

    def port(self):
        self.path = self.directory.name + "/can0"
        return "slcan:" + self.path

    def open(self):
        return can.Bus(interface="slcan", channel=self.path, sleep_after_open=0)

    def test_version_and_serial_number_are_told(self):
        bus = self.connect()
        self.assertEqual(bus.get_version(TIMEOUT), (10, 13))
        self.assertEqual(bus.get_serial_number(TIMEOUT), "STAT")

    def test_a_burst_of_a_hundred_thousand_frames_arrives(self):
        terminal = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        os.write(terminal, b"O\rt%03X0\r" % BURST_REQUEST)
        self.assertEqual(count_lines(terminal, b"t", BURST), BURST)
        os.close(terminal)

    def test_the_next_program_finds_nothing_of_what_a_killed_one_left(self):
        terminal = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        os.write(terminal, b"O\rt%03X0\r" % BURST_REQUEST)
        select.select([terminal], [], [], TIMEOUT)
        os.close(terminal)
        # Its burst goes on until the port notices; from then on there is silence.
        deadline = time.monotonic() + TIMEOUT
        while time.monotonic() < deadline:
            terminal = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
            quiet = not select.select([terminal], [], [], 0.2)[0]
            if quiet:
                os.write(terminal, b"V\r")
                select.select([terminal], [], [], TIMEOUT)
                self.assertEqual(os.read(terminal, 64), b"V1013\r")
            os.close(terminal)
            if quiet:
                return
        self.fail("frames for a program that is gone reach the next one")


def count_lines(descriptor, begin, wanted):
    """Reads lines that begin with `begin` until `wanted` have come or nothing more comes."""
    count, rest = 0, b""
    while count < wanted and select.select([descriptor], [], [], 5.0)[0]:
        *lines, rest = (rest + os.read(descriptor, 65536)).split(b"\r")
        count += sum(line.startswith(begin) for line in lines)
    return count


class SlcanOverTcp(SharedCases, unittest.TestCase):
    client_burst = 5_000

    def port(self):
        return "slcan-tcp:0"

    def open(self):
        bus = can.Bus(interface="slcan", channel=f"socket://127.0.0.1:{self.relay.tcp_port()}", sleep_after_open=0)
        bus.get_version(TIMEOUT)  # the adapter has taken what was sent before
        return bus

    def test_a_burst_of_a_hundred_thousand_frames_arrives(self):
        with socket.create_connection(("127.0.0.1", self.relay.tcp_port())) as connection:
            connection.sendall(b"O\rt%03X0\r" % BURST_REQUEST)
            self.assertEqual(count_lines(connection.fileno(), b"t", BURST), BURST)


class Socketcand(SharedCases, unittest.TestCase):
    remote_frames = False
    # python-can 4.1 takes every frame for an extended one.
    extended_flag = False

    def port(self):
        return "socketcand:0"

    def open(self):
        return can.Bus(interface="socketcand", host="127.0.0.1", port=self.relay.tcp_port(), channel="can0")

    def test_answers_come_at_once(self):
        """Without acknowledgements at once a frame behind another one waits 40 ms each time."""
        bus = self.connect()
        start = time.monotonic()
        for _ in range(100):
            bus.send(frame(0x200, b"\x01"))
            bus.send(frame(0x300, b"\x02"))
            self.receive(bus, 0x301)
        self.assertLess(time.monotonic() - start, 100 * 0.040 / 2)


class CanExec(SharedCases, unittest.TestCase):
    """python-can's interface "socketcan", can-utils and the relay's own SocketCAN port, preloaded."""

    # Set for this process by main(), which starts it anew with the library.
    name = f"t{os.getpid()}"

    def port(self):
        return "can-exec:" + self.name

    def open(self):
        return can.Bus(interface="socketcan", channel=self.name)

    def test_candump_shows_what_cansend_sends_and_the_answer(self):
        self.connect()
        with subprocess.Popen(["candump", "-x", "-n", "4", self.name], stdout=subprocess.PIPE, text=True) as dump:
            try:
                # candump says nothing when it is ready; frames are repeated until it has seen enough.
                while dump.poll() is None:
                    subprocess.run(["cansend", self.name, "123#DEADBEEF"], check=True)
                    time.sleep(0.02)
                output = dump.communicate()[0]
            finally:
                dump.kill()
        self.assertEqual(dump.returncode, 0)
        self.assertIn(f"{self.name}  TX - -  123   [4]  DE AD BE EF", output)
        self.assertIn(f"{self.name}  RX - -  124   [4]  DE AD BE EF", output)

    def test_filters_let_pass_what_they_say(self):
        bus = self.connect()
        bus.set_filters([{"can_id": 0x201, "can_mask": 0x7FF, "extended": False}])
        bus.send(frame(0x100))
        bus.send(frame(0x200))
        self.assertEqual(bus.recv(TIMEOUT).arbitration_id, 0x201)
        self.assertIsNone(bus.recv(0.05))

    def test_inverted_and_joined_filters(self):
        raw = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        raw.settimeout(TIMEOUT)
        inverted = b"".join((0x20000000 | each).to_bytes(4, "little") + b"\xff\x07\x00\x00" for each in (0x101, 0x102))
        raw.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, inverted)
        raw.setsockopt(socket.SOL_CAN_RAW, 6, 1)
        raw.bind((self.name,))
        bus = self.connect()
        for identifier in (0x100, 0x101, 0x103):
            bus.send(frame(identifier))
        heard = []
        while 0x104 not in heard:
            data, address = raw.recvfrom(16)
            heard.append(int.from_bytes(data[:4], "little"))
            self.assertEqual(address, (self.name,))
        self.assertNotIn(0x101, heard)
        self.assertNotIn(0x102, heard)
        self.assertIn(0x103, heard)
        self.assertEqual(raw.getsockname(), (self.name,))
        raw.close()

    def test_own_messages_are_heard_when_asked_for(self):
        bus = can.Bus(interface="socketcan", channel=self.name, receive_own_messages=True)
        self.buses.append(bus)
        bus.send(frame(0x10))
        own = self.receive(bus, 0x10)
        self.assertFalse(own.is_rx)

    def test_time_stamps_are_the_machine_s(self):
        bus = self.connect()
        bus.send(frame(0x10))
        self.assertAlmostEqual(self.receive(bus, 0x11).timestamp, time.time(), delta=5)

    def test_cyclic_frames_are_sent_changed_and_stopped(self):
        bus = self.connect()
        task = bus.send_periodic(frame(0x80, b"\x01"), 0.005)
        for _ in range(5):
            self.receive(bus, 0x81)
        task.modify_data(frame(0x80, b"\x02"))
        while bytes(self.receive(bus, 0x81).data) != b"\x02":
            pass
        task.stop()
        while bus.recv(0.2) is not None:
            pass

    def test_a_copy_of_a_socket_works_in_another_process(self):
        bus = self.connect()
        child = os.fork()
        if child == 0:
            try:
                bus.send(frame(0x20))
                os._exit(0)
            finally:
                os._exit(1)  # whatever was raised, the tests are the parent's
        _, status = os.waitpid(child, 0)
        self.assertEqual(os.waitstatus_to_exitcode(status), 0)
        self.receive(bus, 0x21)

    def test_what_linux_refuses_is_refused(self):
        with socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as raw:
            with self.assertRaises(OSError):
                raw.bind(("nocan",))
            raw.bind((self.name,))
            with self.assertRaises(OSError):
                raw.send(bytes(15))
            with self.assertRaises(OSError):
                raw.send(b"\0\0\0\0\x09" + bytes(11))
        with self.assertRaises(OSError):
            socket.socket(socket.PF_CAN, socket.SOCK_DGRAM, socket.CAN_ISOTP)

    def test_socketcan_port_bridges_to_another_transport(self):
        bridge = Relay("socketcan:" + self.name, "socketcand:0", environment=client_environment())
        try:
            bus = can.Bus(interface="socketcand", host="127.0.0.1", port=bridge.tcp_port(1), channel="can0")
            self.buses.append(bus)
            bus.send(frame(0x40, b"\x07"))
            self.assertEqual(bytes(self.receive(bus, 0x41).data), b"\x07")
        finally:
            bridge.stop()


class UdpMulticast(EchoCases, unittest.TestCase):
    own_frames = True

    def port(self):
        return "udp-multicast:"

    def open(self):
        return can.Bus(interface="udp_multicast", channel="239.74.163.2")


def start_again(environment, *command):
    """Replaces this process by itself, in another surrounding."""
    os.environ.update(environment)
    arguments = [*command, sys.executable, os.path.abspath(sys.argv[0]), *sys.argv[1:]]
    os.execvp(arguments[0], arguments)


def may_have_a_network_of_its_own():
    return subprocess.run(["unshare", "--net", "true"], stderr=subprocess.DEVNULL, check=False).returncode == 0


def enter_surroundings(library, bus):
    """Starts the program again as "stator can-exec" does for `bus`, whose bus may start later, and in
    a network of its own where multicast goes over the loopback. True: it has such a network."""
    if "STATOR_CAN_EXEC" not in os.environ:
        path = f"/tmp/stator-can-exec-{os.getuid()}/{bus}"
        start_again({"STATOR_CAN_EXEC": f"{bus}={path}", "LD_PRELOAD": os.path.abspath(library)})
    if "STATOR_TEST_NETWORK" not in os.environ and may_have_a_network_of_its_own():
        start_again({"STATOR_TEST_NETWORK": "own"}, "unshare", "--net")
    if "STATOR_TEST_NETWORK" not in os.environ:
        return False
    for command in ("ip link set lo up", "ip route add 224.0.0.0/4 dev lo"):
        subprocess.run(command.split(), check=False, stderr=subprocess.DEVNULL)
    return True


def main():
    global UdpMulticast
    # python-can tells of every read that ends inside a message.
    logging.getLogger("can").setLevel(logging.CRITICAL)
    parser = argparse.ArgumentParser()
    parser.add_argument("--relay", required=True)
    parser.add_argument("--library", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    if not enter_surroundings(OPTIONS.library, CanExec.name):
        UdpMulticast = unittest.skip("needs a network namespace (root)")(UdpMulticast)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
