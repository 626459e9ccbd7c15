#!/usr/bin/env python3
"""That comparing finds what differs: one line, one sentence, one bit of a recording, one value of a signal.

tests/frozen/test_differences.py PROGRAM
"""

import contextlib
import io
import os
import shutil
import stat
import sys
import tempfile
import unittest
from argparse import Namespace
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests" / "rigs"), str(HERE)]

import frozen  # noqa: E402

from comparison import recordings, refusals, texts  # noqa: E402
from comparison.outcome import Outcome, Report, difference, run  # noqa: E402

PROGRAM = os.path.abspath(sys.argv.pop()) if len(sys.argv) > 1 else None
RECORDING = min((ROOT / "tests/data/recordings").glob("*.stator"), key=lambda path: path.stat().st_size)

# Says what the program says, but for one thing.
WRAPPER = """#!/bin/sh
if [ "$1" = "{command}" ]; then
  "{program}" "$@" > "{folder}/said.$$"
  status=$?
  sed '{edit}' "{folder}/said.$$"
  {after}
  exit $status
fi
exec "{program}" "$@"
"""


class Differences(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def altered(self, command, edit="", after=":"):
        path = self.folder / "altered"
        path.write_text(WRAPPER.format(command=command, program=PROGRAM, folder=self.folder, edit=edit, after=after))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return str(path)

    def found(self, part, new, **options):
        """(differences, what was printed)"""
        report = Report("part")
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            part(PROGRAM, new, Namespace(jobs=2, seed=1, count=1, keep=None, **options), report)
        return report.differences, printed.getvalue()

    def only_frozen(self, name, new):
        options = Namespace(stator=new, jobs=2, freeze=False)
        return frozen.PARTS[name](options, frozen.DATA / name)

    def test_of_outcomes_are_told_part_by_part(self):
        same = Outcome(0, b"a\nb\n", b"")
        self.assertEqual(difference(same, Outcome(0, b"a\nb\n", b"")), [])
        self.assertIn("exit status", difference(same, Outcome(1, b"a\nb\n", b""))[0])
        self.assertIn("    -b", difference(same, Outcome(0, b"a\nc\n", b"")))
        self.assertIn("ends of lines", difference(same, Outcome(0, b"a\r\nb\r\n", b""))[0])
        self.assertIn("errors", difference(same, Outcome(0, b"a\nb\n", b"x"))[0])
        self.assertEqual(len(difference(same, Outcome(0, b"a\nb\n\xff", b""))), 2)

    def test_a_line_of_a_list_is_found(self):
        asked = texts.Questions(PROGRAM)
        new = self.altered("faults", "s/kelvin/celsius/")
        told = [
            arguments
            for arguments in asked.all()
            if arguments[:1] == ["faults"] and difference(texts.asked(PROGRAM, arguments), texts.asked(new, arguments))
        ]
        self.assertIn(["faults", "over-temperature"], told)
        self.assertNotIn(["faults", "can-drop"], told)

    def test_everything_that_can_be_asked_is_asked(self):
        asked = [" ".join(arguments) for arguments in texts.Questions(PROGRAM).all()]
        self.assertGreater(len(asked), 500)
        for one in (
            "describe tmcm-142 --commands --format csv",
            "export eds tmcc160",
            "simulate move --help",
            "describe junction --format json",
            "faults set --format markdown",
        ):
            self.assertIn(one, asked)

    def test_of_the_program_with_itself_there_is_none(self):
        self.assertEqual(self.only_frozen("refused_scenarios", PROGRAM), [])

    def test_a_word_of_a_sentence_is_found(self):
        told = self.only_frozen("refused_racks", self.altered("check", "s/did you mean/perhaps/"))
        self.assertTrue(any("device-of-unknown-type.toml" in text and "perhaps" in text for text in told), told)

    def test_an_exit_status_is_found(self):
        told = self.only_frozen("refused_scenarios", self.altered("test", "", "status=0"))
        self.assertTrue(any("exit status" in text for text in told), told)

    def test_a_bit_of_a_recording_is_found(self):
        content = bytearray(RECORDING.read_bytes())
        content[len(content) // 2] ^= 4
        damaged = self.folder / "damaged.stator"
        damaged.write_bytes(content)
        lines, _, _ = recordings.compared(PROGRAM, PROGRAM, damaged, self.folder)
        self.assertTrue(lines)

    def test_a_value_of_a_signal_is_found_with_its_name(self):
        new = self.altered("replay", "", "[ -f new.csv ] && sed -i '20s/,0,/,0.5,/' new.csv")
        lines, outcome, shown = recordings.compared(PROGRAM, new, RECORDING, self.folder)
        self.assertEqual(outcome.status, 0)
        self.assertGreater(shown["rows of signals"], 100)
        self.assertEqual(len(lines), 2, lines)
        self.assertIn("row 19", lines[1])

    def test_what_is_written_into_a_rack_file_is_drawn_from_every_table(self):
        drawn = [what for what, _ in refusals.drawn(PROGRAM, 1)]
        self.assertGreater(len(drawn), 3000)
        self.assertTrue(any(what.startswith("wire") for what in drawn))

    def test_a_recording_that_is_gone_is_found(self):
        copy = self.folder / "recordings"
        shutil.copytree(RECORDING.parent, copy)
        kept = sorted(copy.glob("*.stator"))[:2]
        for path in copy.glob("*.stator"):
            if path not in kept:
                path.unlink()
        lines = (copy / "signals.sha256").read_text().splitlines()
        (copy / "signals.sha256").write_text(
            "\n".join(line for line in lines if kept[0].name in line or kept[1].name in line) + "\n"
        )
        kept[0].unlink()
        root, frozen.ROOT = frozen.ROOT, self.folder
        self.addCleanup(setattr, frozen, "ROOT", root)
        told = frozen.signals(Namespace(stator=PROGRAM, jobs=1, freeze=False), copy)
        self.assertEqual(len(told), 1, told)
        self.assertIn("not there", told[0])


if __name__ == "__main__":
    assert run(PROGRAM, ["devices"], ROOT).status == 0
    unittest.main()
