import tempfile
import unittest
from pathlib import Path
from unittest import mock

from loading import load, write_tree

device_pages = load("device_pages")

TREE = {
    "docs/conformance/chip.csv": "id,status,tests,note\nC-1,done,Chip.Counts,\n",
    "tests/data/chip/requirements.csv": "id,block,requirement,source\nC-1,Counters,Counts up.,L7\n",
    "docs/devices/chip.md": "# Chip\n",
}
# Lists the products given to it; describes every device as one line with its own arguments.
STATOR = """#!/bin/sh
if [ "$1" = devices ]; then echo "DEVICE  WHAT"; echo "{products}"; else echo "table of $*"; fi
"""


class DevicePages(unittest.TestCase):
    def run_script(self, *arguments, products="other  a product", without=()):
        """Runs the script on a small tree; returns the pages afterwards."""
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, {path: text for path, text in TREE.items() if path not in without})
            stator = Path(root) / "stator"
            stator.write_text(STATOR.replace("{products}", products), encoding="utf-8")
            stator.chmod(0o755)
            with (
                mock.patch.object(device_pages, "ROOT", Path(root)),
                mock.patch("sys.argv", ["device_pages.py", "--stator", str(stator), *arguments]),
                mock.patch("builtins.print"),
            ):
                device_pages.main()
            return {path.name: path.read_text(encoding="utf-8") for path in (Path(root) / "docs/devices").iterdir()}

    def test_a_product_gets_its_objects(self):
        pages = self.run_script(products="chip  a product")
        self.assertEqual(sorted(pages), ["chip-objects.md", "chip-requirements.md", "chip.md"])
        self.assertIn("table of describe chip --format markdown", pages["chip-objects.md"])

    def test_peripherals_of_an_io_chip_are_made_again(self):
        tree = {**TREE, "docs/devices/chip-peripherals.md": "old"}
        with mock.patch.dict(TREE, tree):
            pages = self.run_script(products="chip  a product")
        self.assertIn("table of describe chip --peripherals --format markdown", pages["chip-peripherals.md"])

    def test_a_bare_controller_gets_its_registers(self):
        pages = self.run_script()
        self.assertEqual(sorted(pages), ["chip-registers.md", "chip-requirements.md", "chip.md"])
        self.assertIn("table of describe chip --registers --format markdown", pages["chip-registers.md"])

    def test_the_page_shows_requirements_with_status_and_tests(self):
        page = self.run_script()["chip-requirements.md"]
        self.assertIn("1 requirements: 1 done, 0 not yet; 0 simplified and 0 left out for good", page)
        self.assertIn("| C-1 | Counts up. (L7) | yes | `Chip.Counts` |", page)

    def test_the_page_tells_what_is_left_out_for_good_from_what_is_to_come(self):
        tree = {
            **TREE,
            "docs/conformance/chip.csv": "id,status,tests,note\nC-1,left-out,,no such pin\n"
            "C-2,open,,without the carry\n",
            "tests/data/chip/requirements.csv": "id,block,requirement,source\n"
            "C-1,Counters,Counts up.,L7\n"
            "C-2,Counters,Counts down.,L8\n",
        }
        with mock.patch.dict(TREE, tree):
            page = self.run_script()["chip-requirements.md"]
        self.assertIn("2 requirements: 0 done, 1 not yet; 0 simplified and 1 left out for good", page)
        self.assertIn("| C-1 | Counts up. (L7) | left out | no such pin |", page)
        self.assertIn("| C-2 | Counts down. (L8) | not yet | without the carry |", page)

    def test_check_refuses_pages_that_are_out_of_date(self):
        with self.assertRaisesRegex(SystemExit, "not up to date: .*chip-requirements.md"):
            self.run_script("--check")

    def test_a_missing_page_is_named(self):
        with self.assertRaisesRegex(SystemExit, "docs/devices/chip.md is missing"):
            self.run_script(without=["docs/devices/chip.md"])


if __name__ == "__main__":
    unittest.main()
