import contextlib
import io
import os
import re
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from loading import load

skipped = load("skipped")

LOG = """Start testing: Nov 27 13:06 UTC
----------------------------------------------------------
1/3 Testing: RealTap.IsThere
1/3 Test: RealTap.IsThere
Command: "test_link"
Directory: /build
"RealTap.IsThere" start time: Nov 27 13:06 UTC
Output:
----------------------------------------------------------
[ RUN      ] RealTap.IsThere
/tests/link/tap_link_test.cpp:144: Skipped
needs a TAP interface: no such
 device

[  SKIPPED ] RealTap.IsThere (0 ms)
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] RealTap.IsThere
<end of output>
Test time =   0.01 sec
----------------------------------------------------------
"RealTap.IsThere" end time: Nov 27 13:06 UTC
----------------------------------------------------------

2/3 Testing: Clients.CanDrive
2/3 Test: Clients.CanDrive
Output:
----------------------------------------------------------
test_can_exec (__main__.Transports.test_can_exec) ... ok
test_socketcan (__main__.Transports.test_socketcan) ... skipped 'no interface of a kernel with CAN is named; there'
<end of output>
"Clients.CanDrive" end time: Nov 27 13:06 UTC

3/3 Testing: Clients.Other
3/3 Test: Clients.Other
Output:
----------------------------------------------------------
not tested: a package is missing
<end of output>
"Clients.Other" end time: Nov 27 13:06 UTC
"""


class Skipped(unittest.TestCase):
    def run_with(self, log, may_skip, tap=False):
        """Exit status and what is printed."""
        rules = [(re.compile("TAP"), lambda: tap), (re.compile("kernel with CAN|package"), lambda: False)]
        said = io.StringIO()
        with tempfile.TemporaryDirectory() as build:
            folder = Path(build, "Testing", "Temporary")
            folder.mkdir(parents=True)
            (folder / "LastTest.log").write_text(log, encoding="utf-8")
            with (
                mock.patch.object(skipped, "RULES", rules),
                mock.patch.object(skipped.sys, "argv", ["skipped.py", build]),
                mock.patch.dict(os.environ, {skipped.MAY_SKIP: may_skip}),
                contextlib.redirect_stdout(said),
            ):
                return skipped.main(), said.getvalue()

    def test_finds_names_and_reasons(self):
        self.assertEqual(
            skipped.skipped(LOG),
            [
                ("Clients.CanDrive, Transports.test_socketcan", "no interface of a kernel with CAN is named; there"),
                ("Clients.Other", "a package is missing"),
                ("RealTap.IsThere", "needs a TAP interface: no such device"),
            ],
        )

    def test_lists_what_the_machine_cannot_do(self):
        status, said = self.run_with(LOG, "0")
        self.assertEqual(status, 0)
        self.assertEqual(said.count("left out: "), 3)

    def test_fails_where_the_machine_can(self):
        status, said = self.run_with(LOG, "0", tap=True)
        self.assertEqual(status, 1)
        self.assertIn("RealTap.IsThere: needs a TAP interface: no such device - but this machine can do that", said)

    def test_only_tells_where_tests_may_be_left_out(self):
        self.assertEqual(self.run_with(LOG, "", tap=True)[0], 0)

    def test_fails_for_a_reason_that_nobody_knows(self):
        self.assertEqual(self.run_with(LOG.replace("TAP interface", "full moon"), "0")[0], 1)

    def test_every_reason_that_tests_give_has_a_rule(self):
        tests = Path(__file__).parents[1]
        reasons = []
        for source in tests.rglob("*.cpp"):
            reasons += re.findall(r'GTEST_SKIP\(\) << "(.*?)"', source.read_text(encoding="utf-8"))
        for source in tests.rglob("*.py"):
            if source != Path(__file__):
                reasons += re.findall(r'skipTest\("(.*?)"\)', source.read_text(encoding="utf-8"))
        self.assertGreater(len(reasons), 6)
        for reason in reasons:
            self.assertTrue(any(pattern.search(reason) for pattern, _ in skipped.RULES), reason)


if __name__ == "__main__":
    unittest.main()
