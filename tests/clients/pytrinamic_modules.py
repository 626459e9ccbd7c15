#!/usr/bin/python3
"""PyTrinamic, unmodified, as the host of TMCM-142 modules over every interface it has for them, and of a
TMCM-3315 over USB, with its tool that loads firmware.

    pytrinamic_modules.py --stator PROGRAM --library LIBRARY [UNITTEST OPTION...]

PROGRAM is `stator`, LIBRARY what "stator can-exec" preloads. "scripts/setup clients" makes the Python that it
runs in.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import unittest

from running_rack import (
    PATIENCE,
    RunningRack,
    enter_python_of_clients,
    free_port,
    preload_bus,
    server_environment,
    unavailable,
    wait_until,
)

enter_python_of_clients()

try:
    import intelhex
    import serial
    from pytrinamic.connections import ConnectionManager
    from pytrinamic.modules import TMCLModule
    from pytrinamic.tmcl import GetInfoRequestError, TMCLCommand, TMCLReplyStatusError, TMCLStatus
except ImportError as error:
    unavailable(str(error), "scripts/setup clients installs it")

OPTIONS = argparse.Namespace(stator=None, library=None)
BUS = f"tmcl{os.getpid()}"
INTERFACE = "can0"  # PyTrinamic takes can0 to can7 only
FIRST, SECOND = 1, 3
SHORT = 1  # s; for answers that are not to come

# Axis parameters of the TMCM-142.
TARGET_POSITION, POSITION, SPEED, MAX_SPEED, ACCELERATION, CURRENT, AT_TARGET = 0, 1, 3, 4, 5, 6, 8

BUS_OF_PORT = """
[[bus]]
bit_rate = "unlimited"
ports = ["{port}"]
"""
MODULE = """
[[{table}]]
type = "tmcm-142"
name = "module{address}"
address = {address}
can_id = {address}
{line}

[{table}.axis]
left_switch = {{ pressed_to = -1.5 }}
"""
MODULE_WITH_USB = """
[[segment]]
link = "udp:127.0.0.1:{port}"

[[segment.device]]
type = "tmcm-3315"
name = "gantry"
usb = "pty:{path}"
"""


def modules(line=None, port=None):
    """The rack file of two modules on one serial line, or on one bus."""
    rack = "" if port is None else BUS_OF_PORT.format(port=port)
    for address in (FIRST, SECOND):
        rack += MODULE.format(
            table="device" if port is None else "bus.device",
            address=address,
            line="" if line is None else f'rs485 = "{line}"',
        )
    return rack


def connect(interface, port, timeout=PATIENCE):
    return ConnectionManager(f"--interface {interface} --port {port} --timeout {timeout}").connect()


class Modules(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="stator-client-")
        self.addCleanup(directory.cleanup)
        self.path = os.path.join(directory.name, "line")

    def refused(self, status, action, *arguments):
        with self.assertRaises(TMCLReplyStatusError) as caught:
            action(*arguments)
        self.assertEqual(caught.exception.status_code, status)

    def host(self, host, address):
        module = TMCLModule(host, address)
        self.assertRegex(host.get_version_string(address), r"142V4\.\d\d$")
        self.refusals(host, module, address)
        self.move(host, module, address)

    def refusals(self, host, module, address):
        self.refused(TMCLStatus.INVALID_COMMAND, host.send, 255, 0, 0, 0, address)
        self.refused(TMCLStatus.WRONG_TYPE, module.set_axis_parameter, 24, 0, 1)
        self.refused(TMCLStatus.INVALID_VALUE, module.set_axis_parameter, CURRENT, 0, 16)
        self.refused(TMCLStatus.INVALID_VALUE, module.get_axis_parameter, CURRENT, 1)
        self.refused(TMCLStatus.INVALID_VALUE, host.rotate, 0, -10_000_000, address)
        self.refused(TMCLStatus.COMMAND_NOT_AVAILABLE, host.send, TMCLCommand.COMP, 0, 0, 0, address)
        module.set_global_parameter(73, 0, 1234)
        self.refused(TMCLStatus.EEPROM_LOCKED, module.store_axis_parameter, CURRENT, 0)
        module.set_global_parameter(73, 0, 4321)
        with self.assertRaises(GetInfoRequestError):
            host.get_info("FWModuleID", module_id=address)

    def move(self, host, module, address):
        module.set_axis_parameter(MAX_SPEED, 0, 60_000_000)
        module.set_axis_parameter(ACCELERATION, 0, 2_000_000)
        for command, speed in ((TMCLCommand.ROR, 10_000_000), (TMCLCommand.ROL, -10_000_000)):
            host.send(command, 0, 0, abs(speed), address)
            wait_until(lambda: module.get_axis_parameter(SPEED, 0, signed=True) == speed, "its speed")
        host.stop(0, address)
        wait_until(lambda: module.get_axis_parameter(SPEED, 0) == 0, "standstill")
        module.set_axis_parameter(POSITION, 0, 0)
        host.move_to(0, 100_000, address)
        wait_until(lambda: module.get_axis_parameter(AT_TARGET, 0) == 1, "the target")
        self.assertEqual(module.get_axis_parameter(POSITION, 0), 100_000)
        host.move_by(0, -150_000, address)
        wait_until(lambda: module.get_axis_parameter(POSITION, 0, signed=True) == -50_000, "the way back")
        host.set_digital_output(0, address)
        self.assertEqual(host.get_digital_output(0, address), 1)

    def other_stands(self, host):
        """What one module was told left the other alone."""
        self.assertEqual(host.get_axis_parameter(POSITION, 0, SECOND), 0)
        self.assertEqual(host.get_digital_output(0, SECOND), 0)

    def session(self, rack_file, interface, port, silence):
        """`silence`: what a host gets that waits in vain."""
        with RunningRack(OPTIONS.stator, rack_file) as rack:
            with connect(interface, port) as host:
                self.host(host, FIRST)
                self.other_stands(host)
                self.host(host, SECOND)
            with (
                connect(interface, port, SHORT) as host,
                rack.fault("power-off", "module1"),
                self.assertRaisesRegex(*silence),
            ):
                while True:  # what was on its way is still heard
                    host.get_axis_parameter(POSITION, 0, FIRST)
            with connect(interface, port) as host:
                self.assertEqual(host.get_axis_parameter(POSITION, 0, FIRST), 0, "it was switched off")
                self.assertEqual(host.get_axis_parameter(POSITION, 0, SECOND, signed=True), -50_000)
                self.host(host, FIRST)

    def test_serial(self):
        self.session(
            modules(line=f"pty:{self.path}"), "serial_tmcl", self.path, (RuntimeError, "TMCL datagram timed out")
        )

    def test_the_command_for_the_boot_loader_is_not_answered(self):
        """So that the next reply belongs to the next command."""
        for rack_file, interface, port in (
            (modules(line=f"pty:{self.path}"), "serial_tmcl", self.path),
            (modules(port=f"can-exec:{BUS}"), "socketcan_tmcl", INTERFACE),
        ):
            with self.subTest(interface), RunningRack(OPTIONS.stator, rack_file), connect(interface, port) as host:
                host.send_boot(FIRST)
                self.assertEqual(host.get_axis_parameter(CURRENT, 0, FIRST), 8)

    def test_usb(self):
        self.session(modules(line=f"pty:{self.path}"), "usb_tmcl", self.path, (RuntimeError, "TMCL datagram timed out"))

    def test_slcan(self):
        self.session(modules(port=f"slcan:{self.path}"), "slcan_tmcl", self.path, (ConnectionError, "Recv timed out"))

    def test_socketcan(self):
        self.session(modules(port=f"can-exec:{BUS}"), "socketcan_tmcl", INTERFACE, (ConnectionError, "Recv timed out"))

    def test_tcp_and_a_rack_that_was_killed(self):
        """Its TCP interface waits for ever for a module that is silent, but sees the end of a connection."""
        port = free_port()
        with RunningRack(OPTIONS.stator, modules(line=f"tcp:{port}")) as rack:
            host = connect("socket_serial_tmcl", f"127.0.0.1:{port}", SHORT)
            self.host(host, FIRST)
            self.other_stands(host)
            rack.kill()
            with self.assertRaises((TimeoutError, ConnectionError)):
                host.get_axis_parameter(POSITION, 0, FIRST)
            host.close()
            with self.assertRaisesRegex(ConnectionError, "Couldn't connect|Failed to"):
                connect("socket_serial_tmcl", f"127.0.0.1:{port}")
            rack.start()
            with connect("socket_serial_tmcl", f"127.0.0.1:{port}") as host:
                self.assertEqual(host.get_axis_parameter(POSITION, 0, FIRST), 0)
                self.host(host, FIRST)

    def test_serial_and_a_rack_that_was_killed(self):
        with RunningRack(OPTIONS.stator, modules(line=f"pty:{self.path}")) as rack:
            host = connect("serial_tmcl", self.path, SHORT)
            self.host(host, FIRST)
            rack.kill()
            with self.assertRaises((serial.SerialException, OSError)):
                host.get_axis_parameter(POSITION, 0, FIRST)
            host.close()
            with self.assertRaises(ConnectionError):
                connect("serial_tmcl", self.path)
            rack.start()
            with connect("serial_tmcl", self.path) as host:
                self.host(host, FIRST)


class Gantry(unittest.TestCase):
    """A TMCM-3315 turns on EtherCAT while PyTrinamic watches it over USB."""

    def setUp(self):
        self.directory = tempfile.TemporaryDirectory(prefix="stator-client-")
        self.addCleanup(self.directory.cleanup)
        self.path = os.path.join(self.directory.name, "usb")
        self.port = free_port()
        self.rack = self.enterContext(
            RunningRack(OPTIONS.stator, MODULE_WITH_USB.format(port=self.port, path=self.path))
        )

    def master(self, *words):
        return subprocess.run(
            [OPTIONS.stator, words[0], "--link", f"udp:127.0.0.1:{self.port}", *words[1:]],
            env=server_environment(),
            text=True,
            capture_output=True,
            timeout=PATIENCE,
            check=False,
        )

    def test_it_is_watched_and_not_moved(self):
        with connect("serial_tmcl", self.path) as host:
            self.assertEqual(host.get_version_string(), "3315V109")
            for action in (
                lambda: host.rotate(0, 1000),
                lambda: host.move_to(0, 1000),
                lambda: host.set_axis_parameter(MAX_SPEED, 0, 1000),
            ):
                with self.assertRaises(TMCLReplyStatusError) as caught:
                    action()
                self.assertEqual(caught.exception.status_code, TMCLStatus.COMMAND_NOT_AVAILABLE)
            self.assertEqual(host.get_axis_parameter(POSITION, 0), 0)
            done = self.master("move", "--revolutions", "2")
            self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
            self.assertEqual(host.get_axis_parameter(POSITION, 0), 2 * 51200)
            self.assertEqual(host.get_axis_parameter(POSITION, 1), 0)

    def upload(self, version):
        image = intelhex.IntelHex()
        image.puts(0x8000, bytes(range(256)) * 4 + version + bytes(3))
        name = os.path.join(self.directory.name, "firmware.hex")
        image.write_hex_file(name)
        return subprocess.run(
            [
                os.path.join(os.path.dirname(sys.executable), "tmclfwupload"),
                name,
                "--interface",
                "serial_tmcl",
                "--port",
                self.path,
                "--timeout",
                str(PATIENCE),
            ],
            text=True,
            capture_output=True,
            timeout=5 * PATIENCE,
            check=False,
        )

    def test_firmware_is_loaded_or_refused_by_its_tool(self):
        done = self.upload(b"3315V110 ")
        self.assertEqual(done.returncode or 0, 0, done.stdout + done.stderr)
        self.assertIn("Checksum of the uploaded firmware matches", done.stdout)
        with connect("serial_tmcl", self.path) as host:
            wait_until(lambda: host.get_version_string().startswith("3315V"), "the module runs again")
        done = self.upload(b"1140V110 ")
        self.assertIn("No matching version string", done.stdout)
        with connect("serial_tmcl", self.path) as host:
            self.assertEqual(host.get_version_string(), "3315B100", "waits in its boot loader")
            host.send_start_app()
            wait_until(lambda: host.get_version_string().startswith("3315V"), "the module runs again")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    parser.add_argument("--library", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    global BUS
    preload_bus(OPTIONS.library, BUS, INTERFACE)
    BUS = os.path.basename(os.environ["STATOR_CAN_EXEC"].split("=")[1])
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
