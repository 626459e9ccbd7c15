"""scripts/lib/checks.sh, which .ci/run and scripts/nightly source."""

import pathlib
import re
import subprocess
import tempfile
import unittest

CHECKS = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib" / "checks.sh"
SCRIPT = """
set -euo pipefail
source {checks}
select_checks "$@"
broken() {{
  echo "error: it is broken"
  false
  echo "never said"
}}
check "one that passes" echo hello
check "one that leaves tests out" echo "left out: B.b: no such device"
check "one/that fails" broken
check "a slow one" python3 -c "import time
while time.process_time() < 1.1: pass"
echo "rest: ${{rest[*]}}"
end_checks
"""


def run(*arguments):
    return subprocess.run(
        ["bash", "-c", SCRIPT.format(checks=CHECKS), "checks", *arguments],
        text=True,
        capture_output=True,
        timeout=60,
        check=False,
    )


class Checks(unittest.TestCase):
    def test_all_run_and_the_last_line_counts_them(self):
        done = run()
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout.splitlines()[-2:], ["failed: one/that fails", "3 passed, 1 failed"])

    def test_a_failed_command_ends_its_check_and_is_repeated_at_the_end(self):
        said = run().stdout
        self.assertNotIn("never said", said)
        self.assertIn("1:error: it is broken", said)

    def test_what_tests_left_out_is_told_at_the_end(self):
        said = run().stdout
        self.assertIn("== what tests left out\nleft out: B.b: no such device\n\n== seconds, ", said)
        self.assertNotIn("what tests left out", run("--only", "slow").stdout)

    def test_the_table_has_the_slowest_first(self):
        table = run().stdout.split("== seconds, and seconds of all processors\n")[1].splitlines()
        rows = [row.groups() for row in (re.fullmatch(r" *(\d+) +(\d+)   (.*)", line) for line in table) if row]
        seconds = [int(row[0]) for row in rows if row[2].strip() != "together"]
        self.assertEqual(len(seconds), 4)
        self.assertEqual(seconds, sorted(seconds, reverse=True))
        slow = next(row for row in rows if row[2] == "a slow one")
        self.assertGreaterEqual(int(slow[0]), 1)
        self.assertGreaterEqual(int(slow[1]), 1)
        self.assertRegex("\n".join(table), r"\d+ +\d+   one/that fails FAILED\n")
        self.assertRegex("\n".join(table), r"\d+ +[1-9]\d*   together\n")

    def test_only_runs_what_has_the_name_in_it(self):
        done = run("--only", "passes", "--only", "slow")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(
            re.findall(r"^== (.*)$", done.stdout, re.MULTILINE),
            ["one that passes", "a slow one", "seconds, and seconds of all processors"],
        )
        self.assertEqual(done.stdout.splitlines()[-1], "2 passed, 0 failed")

    def test_a_name_that_nobody_has_is_an_error(self):
        done = run("--only", "unheard")
        self.assertEqual(done.returncode, 2)
        self.assertIn('no check is called "unheard"', done.stderr)

    def test_list_runs_nothing(self):
        done = run("--list")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(
            [line for line in done.stdout.splitlines() if not line.startswith("rest")],
            ["one that passes", "one that leaves tests out", "one/that fails", "a slow one"],
        )

    def test_other_arguments_are_left_to_the_script(self):
        self.assertIn("rest: --seconds 5", run("--only", "passes", "--seconds", "5").stdout)


BESIDE = """
set -euo pipefail
source {checks}
select_checks "$@"
waits() {{
  until test -e {mark}; do sleep 0.01; done
  echo "it has seen the mark"
  "$1"
  echo "said if it passed"
}}
check_beside "one beside" waits true
check_beside "one that fails beside" waits false
check "a mark" touch {mark}
join_checks
check "a later one" echo later
end_checks
"""


class ChecksBesideOthers(unittest.TestCase):
    def run_beside(self, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            script = BESIDE.format(checks=CHECKS, mark=pathlib.Path(folder) / "mark")
            return subprocess.run(
                ["bash", "-c", script, "checks", *arguments], text=True, capture_output=True, timeout=60, check=False
            )

    def test_they_run_beside_those_that_follow_and_are_shown_when_they_are_joined(self):
        done = self.run_beside()
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        said = done.stdout
        self.assertLess(said.index("== one beside begins"), said.index("== a mark\n"))
        self.assertLess(said.index("== a mark\n"), said.index("it has seen the mark"))
        self.assertLess(said.index("it has seen the mark"), said.index("== a later one\n"))
        self.assertEqual(said.splitlines()[-2:], ["failed: one that fails beside", "3 passed, 1 failed"])
        self.assertEqual(said.count("said if it passed"), 1)
        self.assertRegex(said, r"-- one beside: passed in \d+ s\n")

    def test_list_names_them_and_only_leaves_them_out(self):
        self.assertIn("one beside\n", self.run_beside("--list").stdout)
        self.assertEqual(self.run_beside("--only", "later").stdout.splitlines()[-1], "1 passed, 0 failed")


if __name__ == "__main__":
    unittest.main()
