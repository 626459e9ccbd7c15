#!/usr/bin/python3
"""What a TMCC160 refuses, as python-canopen (PyPI) reports it: abort codes of SDOs, errors of LSS,
emergencies, and NMT commands that change nothing.

    canopen_refusals.py --stator PROGRAM [UNITTEST OPTION...]

PROGRAM is `stator`. "scripts/setup clients" makes the Python that it runs in.
"""

import argparse
import sys
import threading
import time
import unittest

from running_rack import RunningRack, enter_python_of_clients, free_port, unavailable

enter_python_of_clients()

try:
    import can  # noqa: F401  canopen needs it
    import canopen
except ImportError as error:
    unavailable(str(error), "scripts/setup clients installs it")

OPTIONS = argparse.Namespace(stator=None)
TIMEOUT = 30.0
NODE = 5
RACK = """
[[bus]]
bit_rate = "unlimited"
ports = ["socketcand:{port}"]

[[bus.device]]
type = "tmcc160"
node_id = {node_id}
lss = true
serial_number = 4711
heartbeat = "20ms"
sdo_timeout = "5s"  # a loaded machine may take its time to pass a frame on
"""


def upload(index, subindex=0):
    return lambda sdo: sdo.upload(index, subindex)


def download(index, subindex, data, *before):
    """Writes `data` after the writes of `before`, each an index, a subindex and bytes."""

    def action(sdo):
        for step in before:
            sdo.download(*step)
        sdo.download(index, subindex, bytes(data))

    return action


def block(mode):
    def action(sdo):
        size = 4 if mode == "wb" else None
        with sdo.open(0x1005, 0, mode, size=size, block_transfer=True) as stream:
            return stream.write(bytes(4)) if mode == "wb" else stream.read()

    return action


def le(value, size=4):
    return value.to_bytes(size, "little")


OFF = (0x1400, 1, le(0xC0000200 + NODE))
EMPTY = (0x1600, 0, b"\0")
SDO_REFUSALS = [
    (0x05040001, "block upload", block("rb")),
    (0x05040001, "block download", block("wb")),
    (0x06010001, "read of a write-only object", upload(0x2095, 5)),
    (0x06010002, "write to a read-only object", download(0x1001, 0, b"\0")),
    (0x06020000, "object that does not exist", upload(0x5000)),
    (0x06040041, "object that cannot be mapped", download(0x1600, 1, le(0x60410010), OFF, EMPTY)),
    (
        0x06040042,
        "mapping of ten bytes",
        download(
            0x1600,
            0,
            b"\3",
            OFF,
            EMPTY,
            (0x1600, 1, le(0x60FF0020)),
            (0x1600, 2, le(0x607A0020)),
            (0x1600, 3, le(0x60400010)),
        ),
    ),
    (0x06070010, "mapping with the wrong length", download(0x1600, 1, le(0x60400008), OFF, EMPTY)),
    (0x06070012, "value that is too long", download(0x6060, 0, le(1))),
    (0x06070013, "value that is too short", download(0x607A, 0, le(1, 2))),
    (0x06090011, "subindex that does not exist", upload(0x1018, 9)),
    (0x06090030, "bit rate that is none", download(0x2704, 0, le(400, 2))),
    (0x06090030, "node-ID that is none", download(0x2705, 0, b"\x80")),
    (0x06090030, "transmission type that is not supported", download(0x1800, 2, b"\2")),
    (0x06090030, "CAN-ID that is restricted", download(0x1014, 0, le(0x101))),
    (0x06090031, "value that is too high", download(0x2010, 1, b"\xff")),
    (0x06090032, "value that is too low", download(0x2010, 1, b"\1")),
    (0x08000020, "wrong signature", download(0x1010, 1, b"SAVE")),
    (0x08000022, "mapping of a PDO in use", download(0x1601, 0, b"\0")),
    (0x08000022, "CAN-ID of a PDO in use", download(0x1801, 1, le(0x40000190))),
    (0x08000022, "inhibit time of a PDO in use", download(0x1801, 3, le(10, 2))),
]


class Bench(unittest.TestCase):
    """A running rack and a CANopen network with its drive."""

    node_id = NODE

    def setUp(self):
        port = free_port()
        rack = RunningRack(OPTIONS.stator, RACK.format(port=port, node_id=self.node_id))
        self.addCleanup(rack.directory.cleanup)
        self.addCleanup(rack.stop)
        self.network = canopen.Network()
        self.network.connect(interface="socketcand", host="127.0.0.1", port=port, channel="can0")
        self.addCleanup(self.network.disconnect)
        self.network.lss.RESPONSE_TIMEOUT = TIMEOUT
        self.node = self.network.add_node(NODE, canopen.ObjectDictionary())
        self.node.sdo.RESPONSE_TIMEOUT = TIMEOUT

    def until(self, what, condition):
        """Looks until `condition` gives something, and returns that."""
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            if found := condition():
                return found
            time.sleep(0.01)
        self.fail(f"{what} never came")

    def emergency(self, code):
        return self.until(
            f"emergency {code:04X}h", lambda: next((each for each in self.node.emcy.log if each.code == code), None)
        )

    def reset(self):
        self.node.nmt.send_command(0x81)
        self.node.nmt.wait_for_bootup(TIMEOUT)


class Refusals(Bench):
    def test_every_abort_of_an_sdo_arrives_with_its_code(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        for code, name, action in SDO_REFUSALS:
            with self.subTest(name):
                self.reset()  # what a case prepares is no other one's business
                with self.assertRaises(canopen.SdoAbortedError) as refused:
                    action(self.node.sdo)
                self.assertEqual(f"{refused.exception.code:08X}", f"{code:08X}")

    def test_aborts_of_a_transfer_under_way_arrive(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        answers, come = [], threading.Event()

        def take(_, data, __):
            answers.append(bytes(data))
            come.set()

        self.network.subscribe(0x580 + NODE, take)

        def exchange(request):
            come.clear()
            if request is not None:
                self.network.send_message(0x600 + NODE, request.ljust(8, b"\0"))
            self.assertTrue(come.wait(TIMEOUT), "no answer")
            return answers[-1]

        name = b"\x40\x08\x10\x00"
        self.assertEqual(exchange(name)[0], 0x41)
        self.assertEqual(exchange(b"\x70"), b"\x80\x08\x10\x00" + le(0x05030000), "toggle bit")
        self.assertEqual(exchange(name)[0], 0x41)
        self.assertEqual(exchange(None), b"\x80\x08\x10\x00" + le(0x05040000), "time-out")
        self.assertEqual(exchange(b"\xe0")[4:], le(0x05040001), "no request")

    def test_errors_of_lss_arrive(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        lss = self.network.lss
        lss.send_switch_state_global(lss.CONFIGURATION_STATE)
        for node_id in (0, 128, 254):
            with self.assertRaisesRegex(canopen.lss.LssError, "1"):
                lss.configure_node_id(node_id)
        for bit_timing in (5, 8, 9):  # reserved, 10 kbit/s, no entry
            with self.assertRaisesRegex(canopen.lss.LssError, "1"):
                lss.configure_bit_timing(bit_timing)
        self.assertEqual(lss.inquire_node_id(), NODE)
        self.assertEqual(lss.inquire_lss_address(canopen.lss.CS_INQUIRE_SERIAL_NUMBER), 4711)
        self.assertEqual(self.node.sdo.upload(0x1018, 4), le(4711))

    def test_nmt_commands_that_are_none_change_nothing(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        for message in (b"\x07\x05", b"\x01", b"\x01\x05\x00", b"\x01\x06"):
            self.network.send_message(0, message)
            for _ in range(2):
                self.assertEqual(self.node.nmt.wait_for_heartbeat(TIMEOUT), "PRE-OPERATIONAL")

    def test_emergencies_tell_of_pdos_that_are_refused(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        self.node.nmt.state = "OPERATIONAL"
        for can_id, data, code in ((0x500, b"\0\0\1", 0x8210), (0x500, bytes(7), 0x8220), (0x300, b"\0\0\2", 0x6320)):
            self.network.send_message(can_id + NODE, data)
            self.emergency(code)

    def test_an_error_of_the_communication_ends_with_its_reset(self):
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        self.node.sdo.download(0x1016, 1, le(0x7F0032))
        self.network.send_message(0x77F, b"\5")
        self.assertEqual(self.emergency(0x8130).register, 0x11)
        self.assertEqual(self.node.sdo.upload(0x1001, 0), b"\x11")
        self.node.nmt.send_command(0x82)
        self.node.nmt.wait_for_bootup(TIMEOUT)
        self.assertEqual(self.node.sdo.upload(0x1001, 0), b"\0")


class Commissioning(Bench):
    """A drive without a node-ID."""

    node_id = 255

    def select(self):
        try:
            return self.network.lss.send_switch_state_selective(0x286, 160, 0x30000, 4711)
        except canopen.lss.LssError:
            return False  # the drive has not started yet

    def test_it_is_found_and_can_be_given_a_node_id(self):
        lss = self.network.lss
        lss.RESPONSE_TIMEOUT = 1.0
        self.until("a node without a node-ID", self.select)
        lss.RESPONSE_TIMEOUT = TIMEOUT
        self.assertEqual(lss.inquire_node_id(), 255)
        lss.configure_node_id(NODE)
        lss.store_configuration()
        lss.send_switch_state_global(lss.WAITING_STATE)
        self.node.nmt.wait_for_heartbeat(TIMEOUT)
        self.assertEqual(self.node.sdo.upload(0x2705, 0), bytes([NODE]))
        self.reset()
        self.assertEqual(self.node.sdo.upload(0x2708, 0), bytes([NODE]))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
