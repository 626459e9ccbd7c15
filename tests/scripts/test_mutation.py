import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from loading import SCRIPTS, write_tree

sys.path.insert(0, str(SCRIPTS / "mutants"))
from sample import draw  # noqa: E402

from places import find_places, rewrite  # noqa: E402


def changes_of(text):
    """(line, what it is, what it becomes) of every mutant of a source."""
    found = []
    for place in find_places(text):
        at = place.operator[0] if place.operator else place.start
        original = text[slice(*place.operator)] if place.operator else text[place.start : place.end]
        found += [
            (text.count("\n", 0, at) + 1, " ".join(original.split()), change) for change in place.changes if change
        ]
    return found


def changes_in(body):
    return {
        (original, change)
        for _, original, change in changes_of("namespace n {\nint f(int a, int b) {\n" + body + "\n}\n}\n")
    }


class Places(unittest.TestCase):
    def test_operators_conditions_numbers_and_statements_are_changed(self):
        self.assertEqual(
            changes_in("if (a < b && a != 7) {\n  b += a;\n  g(b);\n}\nreturn a - b;"),
            {
                ("a < b && a != 7", "true"),
                ("a < b && a != 7", "false"),
                ("&&", "||"),
                ("<", "<="),
                ("<", ">="),
                ("!=", "=="),
                ("7", "7 + 1"),
                ("b += a;", "nothing"),
                ("+=", "-="),
                ("g(b);", "nothing"),
                ("-", "+"),
            },
        )

    def test_a_loop_is_never_made_endless_by_its_condition(self):
        self.assertEqual(changes_in("while (a) {\n}"), {("a", "false")})

    def test_both_ways_of_a_choice_are_taken(self):
        self.assertEqual(changes_in("return a ? b : a;"), {("a", "true"), ("a", "false")})

    def test_what_has_no_run_time_or_is_text_stays(self):
        for body in (
            "constexpr int kA = 3 + 4;",
            "static_assert(1 + 1 == 2);",
            "using T = X<3>;",
            'say("1 + 1");',
            "// return 1 + 1;",
            "std::array<int, 4> x{};",
            "const int limit = 3;",
            "if constexpr (kA < 3) {\n}",
            "values.reserve(3);",
            "int* p = &a;",
            "switch (a) {\n  case 3:\n    break;\n}",
        ):
            expected = {('say("1 + 1");', "nothing")} if body.startswith("say") else set()
            self.assertEqual(changes_in(body), expected, body)

    def test_the_values_in_an_events_text_stay(self):
        self.assertEqual(
            changes_in("report(kRule, {EventArgument(a + 1)});"),
            {("report(kRule, {EventArgument(a + 1)});", "nothing")},
        )

    def test_declarations_are_not_left_out(self):
        for body in (
            "Thing thing(a);",
            "std::vector<int> v(a);",
            "auto x = g(a);",
            "const auto& y = g(a);",
            "for (int i = a; g(i); ++i) {\n}",
        ):
            self.assertEqual(changes_in(body), set(), body)

    def test_only_function_bodies_are_changed(self):
        self.assertEqual(
            changes_of(
                "const int kTable[] = {1 + 2, 3};\nenum class E { a = 1 };\n"
                "struct S {\n  int x = 3;\n};\n"
                "S::S() : x_(1), y_{2} {\n  x_ = 0;\n}\n"
            ),
            [(7, "x_ = 0;", "nothing"), (7, "0", "1")],
        )


ARITHMETIC = """#include <cstdio>
#include <cstdlib>
namespace {
int less(int a, int b) {
  return a < b;
}
int both(bool a, bool b) {
  return a && b;
}
int sum(int a, int b) {
  int sum = a + b * 2;
  sum += a;
  if (sum > 100) {
    return 100;
  }
  return sum;
}
}  // namespace
int main() {
  std::printf("%d%d%d %d%d %d %d", less(1, 2), less(2, 2), less(3, 2), both(true, false), both(true, true), sum(3, 4), sum(60, 0));
}
"""


class Schemata(unittest.TestCase):
    """One program with all its mutants, compiled once."""

    @classmethod
    def setUpClass(cls):
        cls.places = find_places(ARITHMETIC.replace("int main", "int main_of"))
        cls.places = [p for p in cls.places if p.start < ARITHMETIC.index("int main")]
        number = 1
        for place in cls.places:
            place.identities = list(range(number, number + len(place.changes)))
            number += len(place.changes)
        cls.folder = tempfile.TemporaryDirectory()
        cls.program = Path(cls.folder.name, "program")
        source = Path(cls.folder.name, "program.cpp")
        source.write_text(rewrite(ARITHMETIC, cls.places, SCRIPTS / "mutants" / "schemata.hpp"), encoding="utf-8")
        subprocess.run(["c++", "-std=c++20", "-o", cls.program, source], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def says(self, original, change):
        """What the program prints with one mutant awake."""
        for place in self.places:
            text = ARITHMETIC[slice(*place.operator)] if place.operator else ARITHMETIC[place.start : place.end]
            if text == original and change in place.changes:
                number = place.identities[place.changes.index(change)]
                return subprocess.run(
                    [self.program], env={"MUTANT": str(number)}, text=True, capture_output=True, check=True
                ).stdout
        self.fail(f"no mutant {original} -> {change}")

    def test_is_the_original_while_all_sleep(self):
        done = subprocess.run([self.program], env={}, text=True, capture_output=True, check=True)
        self.assertEqual(done.stdout, "100 01 14 100")

    def test_does_what_the_one_that_is_awake_says(self):
        self.assertEqual(self.says("<", "<="), "110 01 14 100")
        self.assertEqual(self.says("<", ">="), "011 01 14 100")
        self.assertEqual(self.says("&&", "||"), "100 11 14 100")
        self.assertEqual(self.says("+", "-"), "100 01 -2 100")
        self.assertEqual(self.says("*", "/"), "100 01 8 100")
        self.assertEqual(self.says("2", "2 + 1"), "100 01 18 100")
        self.assertEqual(self.says("+=", "-="), "100 01 8 0")
        self.assertEqual(self.says("sum += a;", "nothing"), "100 01 11 60")
        self.assertEqual(self.says("sum > 100", "true"), "100 01 100 100")
        self.assertEqual(self.says("sum > 100", "false"), "100 01 14 120")
        self.assertEqual(self.says("100", "100 + 1"), "100 01 14 100")


PROJECT = {
    ".gitignore": "build/\n",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.25)
project(sample CXX)
set(CMAKE_CXX_STANDARD 20)
find_package(GTest REQUIRED)
add_library(stator_clock STATIC src/stator/clock/clock.cpp)
target_include_directories(stator_clock PUBLIC src)
add_subdirectory(tests/clock)
""",
    "tests/clock/CMakeLists.txt": """add_executable(test_clock clock_test.cpp)
target_link_libraries(test_clock PRIVATE stator_clock GTest::gtest_main)
""",
    "src/stator/clock/clock.hpp": "int hours_after(int hour, int later);\nint floor_to(int value, int step);\n",
    "src/stator/clock/clock.cpp": """#include "stator/clock/clock.hpp"

int hours_after(int hour, int later) {
  int at = hour + later;
  while (at >= 24) {
    at -= 24;
  }
  return at;
}

int floor_to(int value, int step) {
  if (step == 0) {
    return value;
  }
  return value / step * step;
}
""",
    "tests/clock/clock_test.cpp": """#include "stator/clock/clock.hpp"

#include <gtest/gtest.h>

TEST(Hours, BeginAgainAfter23) {
  EXPECT_EQ(hours_after(20, 5), 1);
  EXPECT_EQ(hours_after(20, 4), 0);
  EXPECT_EQ(hours_after(1, 2), 3);
}

TEST(Hours, OfOneDayAreTheirSum) { EXPECT_EQ(hours_after(2, 3), 5); }
""",
}


class Campaign(unittest.TestCase):
    """Of a project with one tested function and one that no test calls."""

    def campaign(self, root, *options):
        report = Path(root, "report.json")
        environment = {key: value for key, value in os.environ.items() if not key.startswith("MUTANT")}
        done = subprocess.run(
            [
                sys.executable,
                "-B",
                SCRIPTS / "mutation",
                "--source",
                Path(root, "sample"),
                "--rooms",
                "clock",
                "--suites",
                "clock",
                "--count",
                "100",
                "--work",
                Path(root, "work"),
                "--report",
                report,
                *options,
            ],
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=environment,
            check=False,
        )
        return done, report

    def test_tells_which_mutants_no_test_notices(self):
        with tempfile.TemporaryDirectory() as root:
            write_tree(Path(root, "sample"), PROJECT)
            subprocess.run(["git", "init", "--quiet", Path(root, "sample")], check=True)
            done, report = self.campaign(root, "--at-least", "0.9")
            self.assertTrue(report.exists(), done.stdout)
            fates = {
                (m["line"], m["original"], m["change"]): m
                for m in json.loads(report.read_text(encoding="utf-8"))["mutants"]
            }
            fate = fates[4, "+", "-"]
            self.assertEqual((fate["result"], fate["test"]), ("killed", "Hours.BeginAgainAfter23"))
            self.assertEqual(fates[5, ">=", ">"]["result"], "killed")
            self.assertEqual(fates[6, "at -= 24;", "nothing"]["result"], "hung")
            self.assertEqual(fates[12, "==", "!="]["result"], "not reached")
            self.assertIn("src/stator/clock/clock.cpp:15: / -> *", done.stdout)
            self.assertNotEqual(done.returncode, 0, "90 % were asked for")
            self.assertIn("90.0% are required", done.stdout)

            # What somebody explained is not drawn, and the same build serves again.
            write_tree(
                Path(root, "sample"),
                {
                    "scripts/mutants/equivalent.csv": "file,line,original,change,reason\n"
                    "src/stator/clock/clock.cpp,if (step == 0) {,==,!=,a test\n"
                },
            )
            done, report = self.campaign(root)
            self.assertEqual(done.returncode, 0, done.stdout)
            again = {
                (m["line"], m["original"], m["change"])
                for m in json.loads(report.read_text(encoding="utf-8"))["mutants"]
            }
            self.assertEqual(set(fates) - again, {(12, "==", "!=")})


class Sampling(unittest.TestCase):
    def test_depends_on_the_seed_and_takes_the_same_of_each_room(self):
        with tempfile.TemporaryDirectory() as root:
            lines = "".join(f"  a += g(a, {i + 2});\n" for i in range(200))
            write_tree(
                root,
                {
                    f"src/stator/{room}/{file}.cpp": f"int f(int a) {{\n{lines}  return a;\n}}\n"
                    for room in ("one", "two")
                    for file in "abcdef"
                },
            )

            def drawn(seed):
                return [str(m) for m in draw(Path(root), ["one", "two"], 60, seed).mutants]

            self.assertEqual(drawn(1), drawn(1))
            self.assertNotEqual(drawn(1), drawn(2))
            self.assertEqual(sum("src/stator/one/" in m for m in drawn(1)), 30)
            self.assertEqual(len(set(drawn(1))), 60)

            def numbers(seed):
                return {str(m): m.number for m in draw(Path(root), ["one", "two"], 400, seed).mutants}

            first, second = numbers(1), numbers(2)
            both = first.keys() & second.keys()
            self.assertGreater(len(both), 20)
            self.assertEqual(
                {m: first[m] for m in both},
                {m: second[m] for m in both},
                "a file is rewritten alike whatever is drawn with it",
            )


if __name__ == "__main__":
    unittest.main()
