#!/usr/bin/python3
"""The lines that the dashboard gives for programs of others (GET /api/v1/connections), pasted: each reaches the
device behind its link.

    pasted_lines.py --stator PROGRAM [UNITTEST OPTION...]

PROGRAM is `stator`. Needs root, for raw sockets on a cable (a veth pair) in a network namespace of its own.
"scripts/setup clients" makes the Python that the lines run in.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import unittest
import urllib.request

from running_rack import (
    PATIENCE,
    RunningRack,
    enter_python_of_clients,
    free_port,
    have_own_network,
    have_priority,
    plug_cable,
    server_environment,
    wait_until,
)

enter_python_of_clients()

OPTIONS = argparse.Namespace(stator=None)
MASTER, SLAVES = "client", "slaves"  # ends of the cable
BUS = f"pasted{os.getpid()}"
SLCAN = f"/tmp/stator-pasted-{os.getpid()}"
LINE = f"/tmp/stator-pasted-line-{os.getpid()}"
RACK = f"""
[[segment]]
link = "ethercat:{SLAVES}"

[[segment.device]]
type = "tmcm-3315"
name = "gantry"

[[bus]]
bit_rate = 1000
ports = ["slcan:{SLCAN}", "socketcand:{{socketcand}}", "can-exec:{BUS}"]

[[bus.device]]
type = "tmcc160"
name = "spindle"
node_id = 5
friendly = true

[[bus.device]]
type = "tmcm-142"
name = "feeder"
can_id = 7
address = 3
rs485 = "pty:{LINE}"

[[device]]
type = "tmcm-142"
name = "winder"
usb = "tcp:{{tcp}}"
"""
DEVICE_TYPE = "9201fcff"  # 1000h of a TMCC160, as its bytes come: CiA 402, and what its data sheet says
VERSION = r"142V\d\.\d\d"


def environment():
    """The programs of the tests stand where a user's would."""
    places = [str(pathlib.Path(OPTIONS.stator).parent), os.path.dirname(sys.executable), os.environ["PATH"]]
    return {**server_environment(), "PATH": os.pathsep.join(places), "PYTHONUNBUFFERED": "1"}


class Pasted(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        plug_cable(SLAVES, MASTER)
        cls.rack = RunningRack(OPTIONS.stator, RACK.format(socketcand=free_port(), tcp=free_port()))
        cls.rack.__enter__()
        address = re.search(r"http://[0-9.]+:\d+", cls.rack.wait_for(r"http://[0-9.]+:\d+")).group()
        with urllib.request.urlopen(address + "/api/v1/connections", timeout=PATIENCE) as answer:
            cls.links = json.load(answer)["links"]

    @classmethod
    def tearDownClass(cls):
        cls.rack.__exit__(None, None, None)

    def lines(self, link, program):
        """Those that are given for the link whose name begins so. In a network of its own the machine does not
        tell which interface is at the other end of the cable, so the person who pastes them does."""
        programs = next(each["programs"] for each in self.links if each["link"].startswith(link))
        return next(each["lines"] for each in programs if each["program"] == program).replace("INTERFACE", MASTER)

    def run_command(self, *command, text=None):
        done = subprocess.run(
            command, input=text, env=environment(), text=True, capture_output=True, timeout=PATIENCE, check=False
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def run_python(self, lines):
        """Started as its first line says, if it says so."""
        way = re.match("# to be started by: (.*) python3 THIS_FILE", lines)
        return self.run_command(*(way.group(1).split() if way else []), "python3", "-", text=lines)

    def test_stator_and_pysoem_find_the_slaves(self):
        link = f"ethercat:{SLAVES}"
        self.assertIn("TMCM-3315", self.run_command("bash", "-e", text=self.lines(link, "stator").split("\n")[0]))
        self.assertEqual(self.run_command("bash", "-e", text=self.lines(link, "pysoem")).strip(), "1")

    def test_python_canopen_reads_the_node_at_every_port(self):
        for port in ("slcan:", "socketcand:", "can-exec:"):
            with self.subTest(port):
                self.assertEqual(self.run_python(self.lines(port, "python-canopen")).split(), ["5", DEVICE_TYPE])

    def test_python_can_hears_frames(self):
        lines = self.lines("slcan:", "python-can")
        with subprocess.Popen(
            ["python3", "-c", lines], env=environment(), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        ) as program:
            try:
                self.assertIn("ID:", program.stdout.readline())
            finally:
                program.kill()

    def test_candump_hears_the_answer_to_cansend(self):
        hear, ask = self.lines("can-exec:", "can-utils").split("\n")
        with subprocess.Popen(hear.split(), env=environment(), text=True, stdout=subprocess.PIPE) as program:
            try:

                def answered():
                    self.run_command(*ask.split())
                    return any("585" in program.stdout.readline() for _ in range(20))

                wait_until(answered, "candump shows the answer")
            finally:
                program.kill()

    def test_pytrinamic_asks_modules_for_their_versions(self):
        for link in ("slcan:", "can-exec:", LINE, "127.0.0.1:"):
            with self.subTest(link):
                self.assertRegex(self.run_python(self.lines(link, "PyTrinamic")), VERSION)

    def test_pyserial_opens_lines(self):
        for link in (LINE, "127.0.0.1:"):
            with self.subTest(link):
                opened = self.run_python(self.lines(link, "pyserial") + "\nprint(line.is_open)")
                self.assertEqual(opened.strip(), "True")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--stator", required=True)
    OPTIONS, rest = parser.parse_known_args()
    OPTIONS.stator = os.path.abspath(OPTIONS.stator)
    have_own_network()
    have_priority()
    unittest.main(argv=[sys.argv[0], *rest])
