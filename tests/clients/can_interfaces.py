#!/usr/bin/python3
"""Unmodified programs that list interfaces, in what "stator can-exec" preloads: iproute2, psutil,
python-can, the C library, and netlink as programs speak it themselves.

    can_interfaces.py --stator PROGRAM --library LIBRARY [UNITTEST OPTION...]
"""

import argparse
import ctypes
import json
import os
import select
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from can_transports import can, enter_surroundings, frame, server_environment

try:
    import psutil
except ImportError as error:
    sys.exit(f"{error}; scripts/setup test installs what is needed")

OPTIONS = argparse.Namespace(stator=None, library=None)
TIMEOUT = 20.0
# A name that python-can looks for; that of this process, which main() starts anew with the library.
BUS = f"vcan{os.getpid()}"
INDEX = 0x4000
RACK = f"""
[[bus]]
bit_rate = 500
ports = ["can-exec:{BUS}"]

[[bus.device]]
type = "tmcc160"
node_id = 1
bit_rate = 500
"""

# linux/rtnetlink.h, linux/netlink.h
NEWLINK, GETLINK, GETADDR, GETROUTE, SETLINK = 16, 18, 22, 26, 19
ERROR, DONE = 2, 3
REQUEST, MULTI, ACK, DUMP = 0x1, 0x2, 0x4, 0x300
IFNAME, MTU = 3, 4
UP = 1


class Bus:
    """`stator run` with a drive at the bus, at 500 kbit/s."""

    def __init__(self):
        self.directory = tempfile.TemporaryDirectory()
        path = os.path.join(self.directory.name, "rack.toml")
        with open(path, "w", encoding="ascii") as file:
            file.write(RACK)
        self.process = subprocess.Popen(
            [OPTIONS.stator, "run", path],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env=server_environment(),
        )
        said = ""
        for line in self.process.stdout:
            said += line
            if line.startswith("Running"):
                return
        self.stop()
        raise RuntimeError(f"stator did not start; it said:\n{said}")

    def stop(self):
        self.process.terminate()
        self.process.wait(TIMEOUT)
        self.process.stdout.close()
        self.directory.cleanup()


def ip(*arguments):
    return subprocess.run(["ip", *arguments], text=True, capture_output=True, check=False)


def ip_json(*arguments):
    done = ip("-json", *arguments)
    assert done.returncode == 0, done
    return json.loads(done.stdout or "[]")


def attribute(kind, content):
    length = 4 + len(content)
    return struct.pack("=HH", length, kind) + content + bytes(-length % 4)


def link_request(sequence, flags, index=0, name=None, kind=GETLINK, wanted=(0, 0)):
    body = struct.pack("=BxHiII", 0, 0, index, *wanted)
    if name is not None:
        body += attribute(IFNAME, name.encode() + b"\0")
    return struct.pack("=IHHII", 16 + len(body), kind, REQUEST | flags, sequence, 0) + body


def messages(datagram):
    """Type, flags, sequence number, port and content of each message."""
    while datagram:
        length, kind, flags, sequence, port = struct.unpack("=IHHII", datagram[:16])
        assert 16 <= length <= len(datagram), datagram
        yield kind, flags, sequence, port, datagram[16:length]
        datagram = datagram[(length + 3) & ~3 :]


def attributes(content):
    found = {}
    while content:
        length, kind = struct.unpack("=HH", content[:4])
        found[kind & 0x3FFF] = content[4:length]
        content = content[(length + 3) & ~3 :]
    return found


def link_index(content):
    return struct.unpack("=i", content[4:8])[0]


class Ifaddrs(ctypes.Structure):
    pass


Ifaddrs._fields_ = [
    ("next", ctypes.POINTER(Ifaddrs)),
    ("name", ctypes.c_char_p),
    ("flags", ctypes.c_uint),
    ("address", ctypes.c_void_p),
]


class OnARunningBus(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = Bus()
        cls.addClassCleanup(cls.bus.stop)
        end = time.monotonic() + TIMEOUT
        while not cls.send_and_receive(0.2):  # until it has booted up
            assert time.monotonic() < end, "the drive does not answer"

    @staticmethod
    def send_and_receive(timeout=TIMEOUT):
        """One frame to the drive, and one from it. False: none came."""
        with can.Bus(interface="socketcan", channel=BUS) as bus:
            bus.send(frame(0x601, bytes.fromhex("4000100000000000")), timeout=TIMEOUT)
            end = time.monotonic() + timeout
            while time.monotonic() < end:
                message = bus.recv(timeout)
                if message is not None and message.arbitration_id == 0x581:
                    return True
        return False

    # iproute2

    def test_ip_lists_the_bus_behind_the_machine_s_interfaces(self):
        links = {each["ifname"]: each for each in ip_json("link")}
        self.assertIn("lo", links)
        bus = links[BUS]
        self.assertEqual(list(links)[-1], BUS)
        self.assertEqual((bus["ifindex"], bus["link_type"], bus["mtu"], bus["operstate"]), (INDEX, "can", 16, "UP"))
        self.assertLessEqual({"UP", "LOWER_UP", "NOARP"}, set(bus["flags"]))

    def test_ip_shows_state_and_bit_timing(self):
        (bus,) = ip_json("-details", "link", "show", "dev", BUS)
        info = bus["linkinfo"]
        self.assertEqual(info["info_kind"], "can")
        self.assertEqual(info["info_data"]["state"], "ERROR-ACTIVE")
        timing = info["info_data"]["bittiming"]
        self.assertEqual(timing["bitrate"], 500000)
        self.assertEqual(timing["sample_point"], "0.875")
        quanta = 1 + timing["prop_seg"] + timing["phase_seg1"] + timing["phase_seg2"]
        self.assertEqual(quanta * timing["tq"] * timing["bitrate"], 1_000_000_000)
        self.assertIn("bitrate 500000 sample-point 0.875", ip("-details", "link", "show", BUS).stdout)

    def test_ip_finds_it_by_kind_and_state_only_where_it_belongs(self):
        # iproute2 prints {} for what it leaves out.
        kind = [each["ifname"] for each in ip_json("link", "show", "type", "can") if each]
        self.assertEqual(kind, [BUS])
        self.assertEqual([each for each in ip_json("link", "show", "type", "vlan") if each], [])
        self.assertIn(BUS, [each.get("ifname") for each in ip_json("link", "show", "up")])
        self.assertNotEqual(ip("link", "show", "dev", "nocan0").returncode, 0)
        self.assertEqual([each["ifname"] for each in ip_json("link", "show", "dev", "lo")], ["lo"])

    def test_ip_shows_no_addresses_of_it_and_the_machine_s_as_ever(self):
        (bus,) = ip_json("address", "show", "dev", BUS)
        self.assertEqual(bus["addr_info"], [])
        addresses = {each["ifname"]: each["addr_info"] for each in ip_json("address")}
        self.assertIn(BUS, addresses)
        plain = subprocess.run(
            ["ip", "-json", "address"], env=server_environment(), check=True, capture_output=True, text=True
        ).stdout
        self.assertEqual(
            {name: info for name, info in addresses.items() if name != BUS},
            {each["ifname"]: each["addr_info"] for each in json.loads(plain)},
        )

    def test_other_requests_of_ip_are_answered_by_the_machine(self):
        for what in (["route"], ["rule"], ["neighbour"], ["-6", "route"]):
            plain = subprocess.run(["ip", *what], env=server_environment(), check=False, capture_output=True, text=True)
            self.assertEqual(ip(*what).stdout, plain.stdout)
            self.assertEqual(ip(*what).returncode, plain.returncode)

    def test_ip_counts_frames(self):
        (before,) = ip_json("-statistics", "link", "show", BUS)
        self.assertTrue(self.send_and_receive())
        (after,) = ip_json("-statistics", "link", "show", BUS)
        sent = after["stats64"]["tx"]
        self.assertEqual(sent["packets"], before["stats64"]["tx"]["packets"] + 1)
        self.assertEqual(sent["bytes"], before["stats64"]["tx"]["bytes"] + 8)
        self.assertGreater(after["stats64"]["rx"]["packets"], before["stats64"]["rx"]["packets"])

    def test_it_is_up_and_nothing_else_can_be_set(self):
        self.assertEqual(ip("link", "set", BUS, "up").returncode, 0)
        for change in (["down"], ["mtu", "72"], ["up", "type", "can", "bitrate", "125000"]):
            refused = ip("link", "set", BUS, *change)
            self.assertEqual(refused.returncode, 2, refused)
            self.assertIn("not supported", refused.stderr)

    # Libraries

    def test_python_can_detects_it(self):
        self.assertEqual(can.detect_available_configs("socketcan"), [{"interface": "socketcan", "channel": BUS}])

    def test_psutil_shows_it_up_and_counts_frames(self):
        self.assertTrue(psutil.net_if_stats()[BUS].isup)
        self.assertEqual(psutil.net_if_stats()[BUS].mtu, 16)
        self.assertEqual(psutil.net_if_stats()["lo"].mtu, 65536)
        before = psutil.net_io_counters(pernic=True)[BUS]
        self.assertTrue(self.send_and_receive())
        after = psutil.net_io_counters(pernic=True)[BUS]
        self.assertEqual(after.packets_sent, before.packets_sent + 1)
        self.assertGreater(after.bytes_recv, before.bytes_recv)

    def test_the_c_library_lists_names_and_indices(self):
        self.assertEqual(socket.if_nameindex()[-1], (INDEX, BUS))
        self.assertIn("lo", [name for _, name in socket.if_nameindex()])
        self.assertEqual(socket.if_nametoindex(BUS), INDEX)
        self.assertEqual(socket.if_indextoname(INDEX), BUS)

    def test_getifaddrs_lists_it_without_an_address(self):
        library = ctypes.CDLL(None)
        first = ctypes.POINTER(Ifaddrs)()
        self.assertEqual(library.getifaddrs(ctypes.byref(first)), 0)
        entries, each = [], first
        while each:
            entries.append((each.contents.name.decode(), each.contents.flags & UP, each.contents.address))
            each = each.contents.next
        library.freeifaddrs(first)
        self.assertEqual([entry for entry in entries if entry[0] == BUS], [(BUS, UP, None)])
        self.assertIn("lo", [name for name, _, _ in entries])

    # Files

    def test_proc_net_dev_has_a_line_more(self):
        with open("/proc/net/dev", encoding="ascii") as file:
            lines = file.read().splitlines()
        self.assertTrue(lines[-1].strip().startswith(BUS + ":"), lines)
        self.assertEqual(len(lines[-1].split(":")[1].split()), 16)
        shell = subprocess.run(["cat", "/proc/net/dev"], check=True, capture_output=True, text=True)
        self.assertIn(f"{BUS}:", shell.stdout)
        self.assertIn("lo:", shell.stdout)

    def test_sys_class_net_has_a_folder_more(self):
        self.assertLessEqual({"lo", BUS}, set(os.listdir("/sys/class/net")))
        content = {}
        for name in ("type", "operstate", "mtu", "ifindex", "flags", "statistics/tx_packets"):
            with open(f"/sys/class/net/{BUS}/{name}", encoding="ascii") as file:
                content[name] = file.read()
        self.assertEqual(
            (content["type"], content["operstate"], content["mtu"], content["ifindex"]),
            ("280\n", "up\n", "16\n", f"{INDEX}\n"),
        )
        self.assertEqual(int(content["flags"], 16) & UP, UP)
        self.assertTrue(os.path.isdir(f"/sys/class/net/{BUS}"))
        self.assertFalse(os.path.exists(f"/sys/class/net/{BUS}/bridge"))
        self.assertFalse(os.path.exists("/sys/class/net/nocan0"))
        with open("/sys/class/net/lo/type", encoding="ascii") as file:
            self.assertEqual(file.read(), "772\n")

    def test_programs_of_the_shell_find_it(self):
        script = (
            "for i in /sys/class/net/*; do [ $(cat $i/type) = 280 ] && echo ${i##*/}; done; "
            "ls -l /sys/class/net >/dev/null && find /sys/class/net/ -name 'v*'"
        )
        done = subprocess.run(["sh", "-c", script], check=True, capture_output=True, text=True)
        self.assertEqual(done.stdout.split(), [BUS, f"/sys/class/net/{BUS}"])
        self.assertEqual(done.stderr, "")

    # Netlink

    def netlink(self):
        opened = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE)
        self.addCleanup(opened.close)
        opened.bind((0, 0))
        opened.settimeout(TIMEOUT)
        return opened

    def test_a_question_about_it_gets_one_answer_and_nothing_more(self):
        link = self.netlink()
        for question in ({"index": INDEX}, {"name": BUS}):
            link.send(link_request(7, 0, **question))
            datagram, sender = link.recvfrom(65536)
            self.assertEqual(sender, (0, 0))
            ((kind, flags, sequence, port, content),) = messages(datagram)
            self.assertEqual((kind, flags, sequence, port), (NEWLINK, 0, 7, link.getsockname()[0]))
            self.assertEqual(link_index(content), INDEX)
            self.assertEqual(attributes(content[16:])[IFNAME], BUS.encode() + b"\0")
            self.assertFalse(select.select([link], [], [], 0)[0])

    def test_an_acknowledgement_that_is_asked_for_comes_behind(self):
        link = self.netlink()
        link.send(link_request(8, ACK, index=INDEX))
        ((kind, _, _, _, _),) = messages(link.recv(65536))
        self.assertEqual(kind, NEWLINK)
        self.assertTrue(select.select([link], [], [], TIMEOUT)[0])
        ((kind, _, sequence, _, content),) = messages(link.recv(65536))
        self.assertEqual((kind, sequence, content[:4]), (ERROR, 8, bytes(4)))
        self.assertFalse(select.select([link], [], [], 0)[0])

    def test_who_waits_for_each_datagram_of_a_listing_gets_all(self):
        for size in (65536, 1024):
            link = self.netlink()
            link.send(link_request(9, DUMP))
            found, kinds = [], []
            while DONE not in kinds:
                self.assertTrue(select.select([link], [], [], TIMEOUT)[0], "nothing more to read")
                ahead = link.recv(65536, socket.MSG_PEEK | socket.MSG_TRUNC)
                datagram = link.recv(max(size, len(ahead)))
                self.assertEqual(datagram, ahead)
                for kind, flags, sequence, _, content in messages(datagram):
                    self.assertEqual(sequence, 9)
                    self.assertTrue(flags & MULTI)
                    kinds.append(kind)
                    if kind == NEWLINK:
                        found.append(link_index(content))
            self.assertEqual(found.count(INDEX), 1)
            self.assertIn(1, found)
            self.assertFalse(select.select([link], [], [], 0)[0])

    def test_a_buffer_too_small_is_told_as_linux_does(self):
        link = self.netlink()
        link.send(link_request(10, 0, index=INDEX))
        _, _, flags, _ = link.recvmsg(64)
        self.assertTrue(flags & socket.MSG_TRUNC)

    def test_questions_in_one_datagram_are_each_answered(self):
        link = self.netlink()
        link.send(link_request(11, 0, index=1) + link_request(12, 0, index=INDEX) + link_request(13, 0, index=0x3FFF))
        answers = []
        while len(answers) < 3:
            answers += [(kind, sequence) for kind, _, sequence, _, _ in messages(link.recv(65536))]
        self.assertEqual(answers, [(NEWLINK, 11), (NEWLINK, 12), (ERROR, 13)])

    def test_copies_of_a_socket_speak_for_it(self):
        link = self.netlink()
        link.send(link_request(14, 0, index=INDEX))
        with link.dup() as copy:
            copy.settimeout(TIMEOUT)
            ((kind, _, _, _, _),) = messages(copy.recv(65536))
        self.assertEqual(kind, NEWLINK)

    def test_a_file_with_the_number_of_a_closed_socket_is_a_file(self):
        for close in (os.close, lambda number: os.closerange(number, number + 1)):
            link = self.netlink()
            link.send(link_request(16, 0, index=INDEX))  # its answer is not read
            number = link.detach()
            close(number)
            file = os.open("/proc/self/stat", os.O_RDONLY)
            try:
                self.assertEqual(file, number)
                self.assertTrue(os.read(file, 100))
            finally:
                os.close(file)

    def test_routes_are_the_machine_s(self):
        link = self.netlink()
        link.send(struct.pack("=IHHIIB11x", 28, GETROUTE, REQUEST | DUMP, 15, 0, socket.AF_INET))
        kinds = set()
        while DONE not in kinds:
            kinds |= {kind for kind, _, _, _, _ in messages(link.recv(65536))}
        self.assertNotIn(NEWLINK, kinds)


class OnABusThatHasEnded(unittest.TestCase):
    def test_the_interface_is_down(self):
        Bus().stop()
        (bus,) = ip_json("-details", "link", "show", "dev", BUS)
        self.assertEqual(bus["operstate"], "DOWN")
        self.assertNotIn("UP", bus["flags"])
        self.assertEqual(bus["linkinfo"]["info_data"]["state"], "STOPPED")
        self.assertFalse(psutil.net_if_stats()[BUS].isup)
        with open(f"/sys/class/net/{BUS}/operstate", encoding="ascii") as file:
            self.assertEqual(file.read(), "down\n")
        self.assertIn("down", ip("link", "set", BUS, "up").stderr)
        self.assertEqual(can.detect_available_configs("socketcan"), [])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    parser.add_argument("--library", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    enter_surroundings(OPTIONS.library, BUS)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
