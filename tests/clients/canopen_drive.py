#!/usr/bin/python3
"""python-canopen, unmodified, as the master of a TMCC160: its own state machine of CiA 402, process data,
refusals, a drive that is lost and found again, over every port that python-can reaches it by.

    canopen_drive.py --stator PROGRAM --library LIBRARY [UNITTEST OPTION...]

PROGRAM is `stator`, LIBRARY what "stator can-exec" preloads. "scripts/setup clients" makes the Python that it
runs in.
"""

import argparse
import contextlib
import os
import sys
import unittest

from racks import DRIVE_NODE as NODE, drive_rack
from running_rack import PATIENCE, RunningRack, enter_python_of_clients, free_port, preload_bus, unavailable, wait_until

enter_python_of_clients()

try:
    import can
    import canopen
    from canopen.nmt import NmtError
    from canopen.profiles.p402 import BaseNode402
    from canopen.sdo.client import SdoClient
    from canopen.sdo.exceptions import SdoAbortedError, SdoCommunicationError
except ImportError as error:
    unavailable(str(error), "scripts/setup clients installs it")

OPTIONS = argparse.Namespace(stator=None, library=None)
BUS = f"canopen{os.getpid()}"
SHORT = 1.0  # s; for answers that are not to come


class Node(BaseNode402):
    """The library's drive; a busy machine is given more than the fractions of a second it grants a drive."""

    TIMEOUT_RESET_FAULT = 1.0
    TIMEOUT_SWITCH_OP_MODE = TIMEOUT_SWITCH_STATE_FINAL = TIMEOUT_SWITCH_STATE_SINGLE = PATIENCE
    TIMEOUT_CHECK_TPDO = TIMEOUT_HOMING_DEFAULT = PATIENCE


class Drive(unittest.TestCase):
    def refused(self, code, action, *arguments):
        with self.assertRaises(SdoAbortedError) as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}")

    def session(self, link, **bus):
        with RunningRack(OPTIONS.stator, drive_rack(link)) as rack:
            network = canopen.Network()
            network.connect(**bus)
            try:
                self.master(network, rack)
            finally:
                network.disconnect()
            rack.stop()
            self.assertRegex(rack.log(), r" 0 dropped, 0 malformed")

    def discover(self, network):
        """The drive that the scanner finds, with the data sheet that it hands out."""
        network.scanner.search()
        wait_until(lambda: network.scanner.nodes, "the scanner finds a node")
        self.assertEqual(network.scanner.nodes, [NODE])
        node = network.add_node(NODE, upload_eds=True)
        self.assertEqual(node.object_dictionary.device_information.product_name, "TMCC160")
        return node

    def master(self, network, rack):
        data_sheet = self.discover(network).object_dictionary
        node = Node(NODE, data_sheet)
        network.add_node(node)
        self.start(node)
        self.refusals(node)
        self.turn(node)
        self.profile(node)
        self.process_data(network, node)
        self.fault(network, node)
        self.lose(rack, node)
        self.start(node)
        self.turn(node)

    def start(self, node):
        """Boot-up, then all that the library wants to know before it runs its state machine."""
        node.nmt.state = "RESET"
        node.nmt.wait_for_bootup(PATIENCE)
        self.assertEqual(node.nmt.state, "PRE-OPERATIONAL")
        self.assertEqual(node.sdo["Manufacturer device name"].raw, "TMCC160")
        node.setup_402_state_machine()
        node.nmt.state = "OPERATIONAL"
        self.assertEqual(node.nmt.wait_for_heartbeat(PATIENCE), "OPERATIONAL")

    def refusals(self, node):
        sdo = node.sdo
        self.refused(0x06010002, sdo.download, 0x6041, 0, b"\0\0")
        self.refused(0x06020000, sdo.upload, 0x5FFF, 0)
        self.refused(0x06090011, sdo.upload, 0x1018, 9)
        self.refused(0x06090030, sdo.download, 0x6060, 0, b"\x07")
        self.refused(0x06070013, sdo.download, 0x60FF, 0, b"\0\0")
        self.refused(0x08000020, sdo.download, 0x1010, 1, b"evil")
        with sdo[0x1008].open("rb") as segments:
            self.assertEqual(segments.read(), b"TMCC160")
        self.refused(0x05040001, lambda: sdo[0x1008].open("rb", block_transfer=True))

    def enable(self, node, mode):
        node.op_mode = mode
        node.state = "OPERATION ENABLED"
        self.assertEqual((node.state, node.op_mode), ("OPERATION ENABLED", mode))

    def turn(self, node):
        """Profile velocity: 1200 rpm, in both directions."""
        self.enable(node, "PROFILED VELOCITY")
        node.sdo[0x2020][3].raw = 20000
        for index in (0x6083, 0x6084):
            node.sdo[index].raw = 10000
        for speed in (1200, -1200, 0):
            node.sdo["Target velocity"].raw = speed
            wait_until(lambda: abs(node.sdo["Velocity actual value"].raw - speed) < 30, f"{speed} rpm")

    def profile(self, node):
        """The library's homing, then ten turns."""
        node.sdo["Homing method"].raw = 17
        node.sdo[0x6099][1].raw = 600
        node.sdo[0x6099][2].raw = 150
        node.op_mode = "HOMING"
        self.assertTrue(node.homing(restore_op_mode=False))
        self.enable(node, "PROFILED POSITION")
        target = node.sdo["Position actual value"].raw + 240
        node.sdo["Target position"].raw = target
        for controlword in (0x0F, 0x1F, 0x0F):
            node.controlword = controlword
        wait_until(lambda: abs(node.sdo["Position actual value"].raw - target) < 3, "ten turns")

    def process_data(self, network, node):
        """TPDO 1 with a mapping of the master's, on SYNC; the controlword by RPDO."""
        node.nmt.state = "PRE-OPERATIONAL"
        node.tpdo.read()
        first = node.tpdo[1]
        first.clear()
        for name in ("Statusword", "Modes of operation display"):
            first.add_variable(name)
        first.trans_type, first.event_timer, first.enabled = 1, 0, True
        first.save()
        node.nmt.state = "OPERATIONAL"
        # Not by the library's wait, which overlooks one that came before it began.
        received = []
        first.add_callback(received.append)
        for count in (1, 2, 3):
            network.sync.transmit()
            wait_until(lambda: len(received) >= count, "TPDO 1 at SYNC")
            self.assertEqual(first["Modes of operation display"].raw, 1)
        node.sdo[0x6040].raw = 0
        node.rpdo.read()
        node.rpdo[1]["Controlword"].raw = 6
        node.rpdo[1].transmit()
        wait_until(lambda: node.sdo["Statusword"].raw & 0x6F == 0x21, "ready to switch on by RPDO")

    def fault(self, network, node):
        """An RPDO with half its bytes: an emergency with the code of CiA 301, kept in the library's list."""
        network.send_message(0x300 + NODE, [6])
        # Not by the library's wait(), which overlooks one that came before it began.
        emergency = wait_until(
            lambda: next((each for each in node.emcy.log if each.code == 0x8210), None), "emergency 8210h"
        )
        self.assertEqual(emergency.register & 0x11, 0x11)

    def lose(self, rack, node):
        with rack.fault("power-off", "drive"):
            node.sdo.RESPONSE_TIMEOUT = SHORT
            with self.assertRaisesRegex(NmtError, "No boot-up or heartbeat received"):
                while True:  # what was on its way is still heard
                    node.nmt.wait_for_heartbeat(2 * SHORT)
            with self.assertRaisesRegex(SdoCommunicationError, "No SDO response received"):
                node.sdo.upload(0x1000, 0)
            node.sdo.RESPONSE_TIMEOUT = PATIENCE
            started = []
            node.nmt.add_heartbeat_callback(started.append)
        wait_until(lambda: 0 in started, "boot-up after the power came back")
        self.assertEqual(node.nmt.state, "PRE-OPERATIONAL")
        self.assertEqual(node.sdo["Modes of operation display"].raw, 0)

    def test_slcan(self):
        path = f"/tmp/{BUS}"
        self.session(f"slcan:{path}", interface="slcan", channel=path, sleep_after_open=0.1)

    def test_slcan_over_tcp(self):
        port = free_port()
        self.session(f"slcan-tcp:{port}", interface="slcan", channel=f"socket://127.0.0.1:{port}", sleep_after_open=0.1)

    def test_socketcand(self):
        port = free_port()
        self.session(f"socketcand:{port}", interface="socketcand", host="127.0.0.1", port=port, channel="can0")

    def test_can_exec(self):
        self.session(f"can-exec:{BUS}", interface="socketcan", channel=BUS)

    def test_a_rack_that_was_killed_is_found_again(self):
        """The library's bus is gone with it; a new one finds the drive as it left the factory."""
        port = free_port()
        with RunningRack(OPTIONS.stator, drive_rack(f"socketcand:{port}")) as rack:
            for life in range(2):
                if life:
                    rack.start()
                network = canopen.Network()
                network.connect(interface="socketcand", host="127.0.0.1", port=port, channel="can0")
                node = self.discover(network)
                self.assertEqual(node.sdo["Target velocity"].raw, 0)
                node.sdo["Target velocity"].raw = 700
                rack.kill()
                node.sdo.RESPONSE_TIMEOUT = SHORT
                with self.assertRaises((SdoCommunicationError, OSError, can.CanError)):
                    node.sdo.upload(0x1000, 0)
                with contextlib.suppress(OSError, can.CanError):
                    network.disconnect()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    parser.add_argument("--library", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    SdoClient.RESPONSE_TIMEOUT = PATIENCE
    global BUS
    preload_bus(OPTIONS.library, BUS)
    BUS = os.environ["STATOR_CAN_EXEC"].split("=")[0]
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
