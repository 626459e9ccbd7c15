#!/usr/bin/python3
"""Masters of other languages, unmodified, that scripts/nightly lets loose on `stator run`: ethercrab and zencan
(Rust), node-canopen (Node.js). Each moves an axis, is refused, loses the device and finds it again; what it
says is what is checked.

    masters.py --stator PROGRAM [UNITTEST OPTION...]

"scripts/setup nightly" installs and builds them below .cache/nightly.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import threading
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from racks import SEGMENT_NAMES, drive_rack, segment_rack  # noqa: E402
from running_rack import (  # noqa: E402
    PATIENCE,
    RunningRack,
    free_port,
    have_own_network,
    have_priority,
    plug_cable,
    unavailable,
    wait_until,
)

OPTIONS = argparse.Namespace(stator=None)
CACHE = HERE.parents[2] / ".cache" / "nightly"
BUS = f"masters{os.getpid()}"
MASTER, SLAVES = "client", "slaves"  # ends of a cable


class Master:
    """A program that says in lines what it sees."""

    def __init__(self, *words, environment=None):
        self.process = subprocess.Popen(
            list(map(str, words)),
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, **(environment or {})},
        )
        self.lines = []
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.strip())
            print(line, end="", flush=True)

    def wait_for(self, begin):
        def found():
            return self.find(begin) or self.process.poll() is not None and not self.thread.is_alive()

        wait_until(found, f"the master says {begin!r}", 4 * PATIENCE)
        lines = self.find(begin)
        assert lines, f"the master ended without {begin!r}; it said:\n" + "\n".join(self.lines)
        return lines

    def find(self, begin):
        return [line for line in self.lines if line.startswith(begin)]

    def end(self):
        """Its exit status; it is ended if it does not by itself."""
        try:
            return self.process.wait(PATIENCE)
        finally:
            self.process.kill()
            self.process.wait()
            self.thread.join()
            self.process.stdout.close()


class Masters(unittest.TestCase):
    maxDiff = None

    def session(self, rack, device, ready, expected, *words, **options):
        """The whole life of a master; twice the `expected` lines, before and after the loss of `device`."""
        with RunningRack(OPTIONS.stator, rack) as running:
            master = Master(*words, **options)
            try:
                master.wait_for(ready)
                before = [line for line in master.lines if line in expected]
                with running.fault("power-off", device):
                    lost = master.wait_for("lost")
                master.wait_for("found")
                self.assertEqual(master.end(), 0)
            finally:
                master.end()
            self.assertEqual(before, expected)
            self.said = master.lines
            after = master.lines[master.lines.index(lost[0]) + 1 :]
            self.assertEqual([line for line in after if line in expected][-len(expected) :], expected)
            return lost[0]

    def test_ethercrab(self):
        refusals = [
            f"refused mailbox: {text}"
            for text in (
                "0x6041:0 aborted: 0x06010002: Attempt to write to a read only object",
                "0x5fff:0 aborted: 0x06020000: The object does not exist in the object directory",
                "0x1018:9 aborted: 0x06090011: Subindex does not exist",
                "0x6060:0 aborted: 0x06090030: Value range of parameter exceeded (only for write access)",
            )
        ]
        expected = (
            [f"device {name}" for name in (*SEGMENT_NAMES[:2], "TMC8461-IO")]
            + 2 * refusals
            + ["operational", "turned 102400"]
        )
        lost = self.session(
            segment_rack(f"ethercat:{SLAVES}"),
            "servo",
            "turned",
            expected,
            CACHE / "rust" / "release" / "ethercrab_segment",
            MASTER,
        )
        self.assertRegex(lost, r"lost working counter \d+ of \d+|lost timeout")

    def test_zencan(self):
        program = CACHE / "rust" / "release" / "zencan_drive"
        expected = [
            "identity 00000286",
            *(
                f"refused Received abort accessing object 0x{place}: {code}"
                for place, code in (
                    ("6041sub0", "ReadOnly"),
                    ("5FFFsub0", "NoSuchObject"),
                    ("1018sub9", "NoSuchSubIndex"),
                    ("6060sub0", "InvalidValue"),
                )
            ),
            "turned 1200",
            "turned 0",
            "state Some(Operational)",
        ]
        lost = self.session(
            drive_rack(f"can-exec:{BUS}"),
            "drive",
            "state",
            expected,
            OPTIONS.stator,
            "can-exec",
            "--bus",
            BUS,
            "--",
            program,
            BUS,
        )
        self.assertEqual(lost, "lost Timeout while awaiting an expected response")
        self.assertIn("node 5 TMCC160", self.said)

    def test_node_canopen(self):
        port = free_port()
        expected = [
            "name TMCC160",
            "refused 06010002 Attempt to write a read only object [0x6041]",
            "refused 06020000 Object does not exist [0x5fff]",
            "refused 06090011 Sub index does not exist [0x1018.9]",
            "refused 06090030 Invalid value for download parameter [0x6060]",
            "turned 1200",
            "turned 0",
        ]
        self.session(
            drive_rack(f"slcan-tcp:{port}"),
            "drive",
            "ready",
            expected,
            "node",
            HERE / "node" / "node_canopen_drive.js",
            port,
            environment={"STATOR_NODE_PACKAGES": str(CACHE / "node")},
        )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    for place in ("rust/release/ethercrab_segment", "rust/release/zencan_drive", "node/installed"):
        if not (CACHE / place).exists():
            unavailable(f"{CACHE / place} does not exist", "scripts/setup nightly makes it")
    have_own_network()
    plug_cable(MASTER, SLAVES)
    have_priority()
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
