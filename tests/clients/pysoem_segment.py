#!/usr/bin/python3
"""pysoem (SOEM for Python), unmodified, as the master of the three EtherCAT products on one segment: it
moves an axis of each, is refused what they refuse, loses them and finds them again with its own recovery.

    pysoem_segment.py --stator PROGRAM [UNITTEST OPTION...]

PROGRAM is `stator`. Needs root, for raw sockets on a cable (a veth pair) in a network namespace of its own.
"scripts/setup clients" makes the Python that it runs in.
"""

import argparse
import pathlib
import struct
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree

from racks import IO_BOARD, SEGMENT_NAMES, segment_rack
from running_rack import (
    PATIENCE,
    RunningRack,
    enter_python_of_clients,
    have_own_network,
    have_priority,
    plug_cable,
    unavailable,
    wait_until,
)

enter_python_of_clients()

try:
    import pysoem
except ImportError as error:
    unavailable(str(error), "scripts/setup clients installs it")

OPTIONS = argparse.Namespace(stator=None)
MASTER, SLAVES = "client", "slaves"  # ends of the cable
GANTRY, SERVO_DRIVE, IO = range(3)
WATCHDOG = 5000.0  # ms; a busy machine may take its time between two frames
REFUSED, NOT_THERE, NO_SUBINDEX, OUT_OF_RANGE = 0x06010002, 0x06020000, 0x06090011, 0x06090030
TOO_LONG, WRONG_STATE = 0x06070012, 0x0011


def process_image(directory):
    """Where the registers of the I/O board lie: (offset, struct format) by name, as its ESI file tells."""
    esi = pathlib.Path(directory) / "io.xml"
    subprocess.run(
        [OPTIONS.stator, "mfc", "config", str(IO_BOARD), "--esi", str(esi)],
        check=True,
        capture_output=True,
        timeout=PATIENCE,
    )
    places = {}
    for kind in ("RxPdo", "TxPdo"):
        offset = 0
        for entry in ElementTree.parse(esi).iter():
            if entry.tag != kind:
                continue
            for each in entry.iter("Entry"):
                size = int(each.findtext("BitLen")) // 8
                places[each.findtext("Name") or f"gap {offset}"] = offset, size
                offset += size
    return places


class Drive:
    """The first axis of CiA 402 in the process data: what it is told and what it tells."""

    def __init__(self, slave, mode=False):
        self.slave = slave
        self.has_mode = mode
        self.controlword = self.target = self.velocity = 0
        self.write()

    def write(self):
        data = bytearray(self.slave.output)
        if self.has_mode:
            struct.pack_into("<HbiiH", data, 0, self.controlword, 1, self.target, self.velocity, 0)
        else:
            struct.pack_into("<Hii", data, 0, self.controlword, self.target, self.velocity)
        self.slave.output = bytes(data)

    def status(self):
        return struct.unpack_from("<H", self.slave.input)[0]

    def position(self):
        return struct.unpack_from("<i", self.slave.input, 3 if self.has_mode else 2)[0]


class Segment(unittest.TestCase):
    def setUp(self):
        self.rack = self.enterContext(RunningRack(OPTIONS.stator, segment_rack(f"ethercat:{SLAVES}")))
        self.image = process_image(self.rack.directory.name)
        self.master = pysoem.Master()
        self.master.open(MASTER)
        self.addCleanup(self.master.close)
        self.master.sdo_read_timeout = self.master.sdo_write_timeout = int(PATIENCE * 1e6)

    # What a master does.

    def configure(self):
        self.assertEqual(self.master.config_init(), len(SEGMENT_NAMES))
        self.assertEqual([slave.name for slave in self.master.slaves], SEGMENT_NAMES)
        for slave in self.master.slaves:
            slave.is_lost = False
        for slave, function in zip(
            self.master.slaves, (self.set_up_gantry, self.set_up_servo, self.set_up), strict=True
        ):
            slave.config_func = function
        self.master.config_map()
        self.master.config_dc()
        self.assertEqual(self.master.state_check(pysoem.SAFEOP_STATE, int(PATIENCE * 1e6)), pysoem.SAFEOP_STATE)
        self.cycle()

    def set_up(self, position):
        """Between Pre-Operational and Safe-Operational, also when the slave is found again."""
        slave = self.master.slaves[position]
        slave.set_watchdog("processdata", WATCHDOG)
        return slave

    def set_up_gantry(self, position):
        gantry = self.set_up(position)
        gantry.sdo_write(0x2005, 0, struct.pack("<I", 3))
        for index, value in ((0x6081, 400_000), (0x6083, 2_000_000), (0x6084, 2_000_000)):
            gantry.sdo_write(index, 0, struct.pack("<I", value))
        gantry.sdo_write(0x6060, 0, b"\x01")

    def set_up_servo(self, position):
        servo = self.set_up(position)
        for index, value in ((0x6081, 2000), (0x6083, 20_000), (0x6084, 20_000)):
            servo.sdo_write(index, 0, struct.pack("<I", value))

    def cycle(self):
        """One exchange of process data; its working counter."""
        self.master.send_processdata()
        return self.master.receive_processdata(int(1e6))

    def cycle_until(self, condition, what):
        def turn():
            self.cycle()
            return condition()

        return wait_until(turn, what, pause=0.001)

    def go_operational(self):
        self.master.state = pysoem.OP_STATE
        self.master.write_state()
        self.cycle_until(lambda: self.master.read_state() == pysoem.OP_STATE, "Operational")
        self.assertEqual(self.cycle(), self.master.expected_wkc)

    def check_states(self):
        """What a master does beside its cycle to get back what is not in Operational: acknowledges errors,
        asks for Operational, configures anew who was restarted, finds who was lost."""
        self.master.read_state()
        for slave in self.master.slaves:
            if slave.state == pysoem.OP_STATE:
                slave.is_lost = False
                continue
            if slave.state == pysoem.SAFEOP_STATE + pysoem.STATE_ERROR:
                slave.state = pysoem.SAFEOP_STATE + pysoem.STATE_ACK
                slave.write_state()
            elif slave.state == pysoem.SAFEOP_STATE:
                slave.state = pysoem.OP_STATE
                slave.write_state()
            elif slave.state > pysoem.NONE_STATE:
                if slave.reconfig():
                    slave.is_lost = False
            elif not slave.is_lost:
                slave.state_check(pysoem.OP_STATE)
                slave.is_lost = slave.state == pysoem.NONE_STATE
            if slave.is_lost and slave.state == pysoem.NONE_STATE and slave.recover():
                slave.is_lost = False

    def recover(self):
        def complete():
            if self.cycle() == self.master.expected_wkc and self.master.read_state() == pysoem.OP_STATE:
                return True
            self.check_states()
            return False

        wait_until(complete, "everybody is in Operational again")

    # What devices do.

    def enable(self, drive):
        for controlword, mask, expected in ((0x80, 0x4F, 0x40), (6, 0x6F, 0x21), (7, 0x6F, 0x23), (15, 0x6F, 0x27)):
            drive.controlword = controlword
            drive.write()
            self.cycle_until(
                lambda: drive.status() & mask == expected, f"the state after controlword {controlword:02X}h"
            )

    def travel(self, drive, distance, tolerance):
        start = drive.position()
        drive.target = start + distance
        drive.controlword = 0x1F
        drive.write()
        self.cycle_until(lambda: drive.status() & 0x1000, "the set-point is taken")
        drive.controlword = 0x0F
        drive.write()
        self.cycle_until(lambda: drive.status() & 0x1400 == 0x400, "the target is reached")
        self.assertAlmostEqual(drive.position(), start + distance, delta=tolerance)

    def move_gantry(self):
        axis = Drive(self.master.slaves[GANTRY])
        self.enable(axis)
        self.travel(axis, 2 * 51_200, 1)

    def move_servo(self):
        axis = Drive(self.master.slaves[SERVO_DRIVE], mode=True)
        self.enable(axis)
        self.travel(axis, 5 * 65_536, 200)

    def register(self, name):
        offset, size = self.image[name]
        return int.from_bytes(self.master.slaves[IO].input[offset : offset + size], "little", signed=True)

    def set_registers(self, **values):
        slave = self.master.slaves[IO]
        data = bytearray(slave.output)
        for name, value in values.items():
            offset, size = self.image[name]
            data[offset : offset + size] = value.to_bytes(size, "little")
        slave.output = bytes(data)

    def move_io(self):
        """A stepper behind step and direction; its encoder comes back in the inputs."""
        self.set_registers(SD_CFG=3, SD_STEPLENGTH=24, SD_CH0_STEPRATE=0, ENC_CONST=65536)
        self.cycle()
        before = self.register("SD_CH0_STEPCOUNT"), self.register("X_ENC")
        self.set_registers(SD_CH0_STEPRATE=549_756)  # 3200 steps/s, a turn each second
        self.cycle_until(lambda: abs(self.register("SD_CH0_STEPCOUNT") - before[0]) > 3200, "one turn")
        self.set_registers(SD_CH0_STEPRATE=0)
        count = None
        while count != self.register("SD_CH0_STEPCOUNT"):
            count = self.register("SD_CH0_STEPCOUNT")
            self.cycle()
            time.sleep(0.1)
            self.cycle()
        steps, counts = abs(count - before[0]), abs(self.register("X_ENC") - before[1])
        self.assertAlmostEqual(counts / steps, 4000 / 3200, delta=0.01)

    # The tests.

    def test_it_moves_an_axis_of_each(self):
        self.configure()
        self.go_operational()
        self.move_gantry()
        self.move_servo()
        self.move_io()

    def sdo_refused(self, code, action, *arguments):
        with self.assertRaises(pysoem.SdoError) as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.abort_code:08X}", f"{code:08X}")

    def test_refused_sdos_raise_their_abort_codes(self):
        self.configure()
        for slave in self.master.slaves[:IO]:
            with self.subTest(slave.name):
                self.sdo_refused(REFUSED, slave.sdo_write, 0x6041, 0, b"\0\0")
                self.sdo_refused(NOT_THERE, slave.sdo_read, 0x5FFF, 0)
                self.sdo_refused(NO_SUBINDEX, slave.sdo_read, 0x1018, 9)
                self.sdo_refused(OUT_OF_RANGE, slave.sdo_write, 0x6060, 0, b"\x63")
                self.sdo_refused(TOO_LONG, slave.sdo_write, 0x6040, 0, b"\0\0\0\0")
                self.assertEqual(slave.sdo_read(0x6041, 0)[1] & 0xF0, 0)
        with self.assertRaises((pysoem.MailboxError, pysoem.WkcError, pysoem.PacketError)):
            self.master.slaves[IO].sdo_read(0x1000, 0)  # it has no mailbox

    def test_refused_states_tell_their_al_status_code(self):
        self.configure()
        for slave in self.master.slaves[:IO]:
            with self.subTest(slave.name):
                slave.state = pysoem.INIT_STATE
                slave.write_state()
                self.assertEqual(slave.state_check(pysoem.INIT_STATE), pysoem.INIT_STATE)
                slave.state = pysoem.OP_STATE
                slave.write_state()
                wait_until(lambda: self.master.read_state() and slave.state & pysoem.STATE_ERROR, "the refusal")
                self.assertEqual(slave.state, pysoem.INIT_STATE + pysoem.STATE_ERROR)
                self.assertEqual(slave.al_status, WRONG_STATE)
                self.assertEqual(pysoem.al_status_code_to_string(slave.al_status), "Invalid requested state change")
                slave.state = pysoem.INIT_STATE + pysoem.STATE_ACK
                slave.write_state()
                self.assertEqual(slave.state_check(pysoem.INIT_STATE), pysoem.INIT_STATE)
        self.rack.wait_for("gantry.*0011h")

    def test_a_device_that_lost_its_supply_is_configured_anew(self):
        """The one behind it is out of reach meanwhile, the one before goes on."""
        self.configure()
        self.go_operational()
        self.move_servo()
        complete = self.master.expected_wkc
        with self.rack.fault("power-off", "servo"):
            self.cycle_until(lambda: 0 < self.cycle() < complete, "a smaller working counter")
            self.master.read_state()
            self.assertEqual(self.master.slaves[GANTRY].state, pysoem.OP_STATE)
            for slave in self.master.slaves[SERVO_DRIVE:]:
                self.assertEqual(slave.state, pysoem.NONE_STATE)
            self.check_states()
            self.assertEqual([slave.is_lost for slave in self.master.slaves], [False, True, True])
        self.recover()
        self.assertEqual([slave.is_lost for slave in self.master.slaves], [False] * 3)
        self.move_servo()
        self.move_io()
        self.move_gantry()

    def test_a_cable_that_was_out_is_plugged_in_again(self):
        self.configure()
        self.go_operational()
        with self.rack.fault("link-down", "gantry"):
            self.cycle_until(lambda: self.cycle() <= 0, "nobody answers")
            self.assertEqual(self.master.slaves[GANTRY].state_check(pysoem.OP_STATE, 10_000), pysoem.NONE_STATE)
        self.recover()
        self.move_gantry()
        self.move_servo()

    def test_a_rack_that_was_killed_is_found_again(self):
        self.configure()
        self.go_operational()
        self.move_gantry()
        self.rack.kill()
        self.cycle_until(lambda: self.cycle() <= 0, "nobody answers")
        self.assertLessEqual(self.master.config_init(), 0)
        self.rack.start()
        self.configure()
        self.go_operational()
        self.move_gantry()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    have_own_network()
    plug_cable(MASTER, SLAVES)
    have_priority()
    timeouts = pysoem.settings.timeouts
    timeouts.ret, timeouts.safe = 100_000, 1_000_000
    timeouts.eeprom = timeouts.tx_mailbox = 2_000_000
    timeouts.rx_mailbox = 10_000_000
    timeouts.state = int(PATIENCE * 1e6)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
