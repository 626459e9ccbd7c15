#!/usr/bin/python3
"""What programs of others say to the electronic data sheet that `stator export eds` writes: eds-utils' validator,
python-canopen, node-canopen.

    data_sheets.py --stator PROGRAM

"scripts/setup nightly" installs them below .cache/nightly.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
CACHE = ROOT / ".cache" / "nightly"
sys.path.insert(0, str(HERE.parent))

from running_rack import PATIENCE, unavailable  # noqa: E402

OPTIONS = argparse.Namespace(stator=None)
PYTHON_CANOPEN = """
import sys, canopen
sheet = canopen.import_od(sys.argv[1])
entries = [(entry.index, getattr(entry, "subindex", 0)) for each in sheet.values()
           for entry in (each.values() if hasattr(each, "values") else [each])]
print(len(sheet), len(entries))
for name in ("Controlword", "Statusword", "Modes of operation", "Position actual value", "Target velocity"):
    print(name, hex(sheet[name].index), sheet[name].access_type, len(sheet[name]))
"""
NODE_CANOPEN = """
const { createRequire } = require('module');
const { Eds } = createRequire(process.argv[1])('canopen');
const eds = Eds.fromFile(process.argv[2]);
let count = 0;
for (const entry of eds.values())
    count += entry.subNumber || 1;
console.log(Object.keys(eds.dataObjects).length, count);
console.log(eds.getEntry('Controlword').index, eds.deviceName || eds.fileName);
"""


def run(*words):
    return subprocess.run(list(map(str, words)), text=True, capture_output=True, timeout=PATIENCE, check=False)


class DataSheets(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="stator-client-")
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name) / "tmcc160.eds"
        done = run(OPTIONS.stator, "export", "eds", "tmcc160", "-o", self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = self.path.read_text(encoding="ascii")
        self.objects = sum(
            int(line.split("=")[1]) for line in text.splitlines() if line.startswith("SupportedObjects=")
        )
        self.entries = sum(line.startswith("AccessType=") for line in text.splitlines())
        self.assertGreater(self.objects, 80)

    def test_eds_validate_finds_nothing(self):
        done = run(CACHE / "python" / "bin" / "eds-validate", self.path)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))

    def test_python_canopen_reads_every_entry(self):
        done = run(CACHE / "python" / "bin" / "python", "-W", "error", "-c", PYTHON_CANOPEN, self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], f"{self.objects} {self.entries}")
        self.assertEqual(
            lines[1:],
            [
                "Controlword 0x6040 rww 16",
                "Statusword 0x6041 ro 16",
                "Modes of operation 0x6060 rww 8",
                "Position actual value 0x6064 ro 32",
                "Target velocity 0x60ff rww 32",
            ],
        )
        self.assertEqual(done.stderr, "")

    def test_node_canopen_reads_every_entry(self):
        done = run("node", "-e", NODE_CANOPEN, CACHE / "node" / "package.json", self.path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines()[0], f"{self.objects} {self.entries}")

    def test_the_project_s_own_checker_finds_nothing(self):
        done = run(sys.executable, ROOT / "scripts" / "check_eds.py", self.path)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--stator", required=True)
    _, rest = parser.parse_known_args(namespace=OPTIONS)
    for place in ("python/installed", "node/installed"):
        if not (CACHE / place).exists():
            unavailable(f"{CACHE / place} does not exist", "scripts/setup nightly makes it")
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
