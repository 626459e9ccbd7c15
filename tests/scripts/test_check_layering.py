import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from loading import load, write_tree

check_layering = load("check_layering")

GOOD_TREE = {
    "docs/architecture.md": (
        "| room | what lives there | may use | portable |\n"
        "|---|---|---|---|\n"
        "| `link` | interfaces | `base` | no |\n"
        "| `drive` | axes | `control`, `base` | yes |\n"
        "| `control` | loops | `base` | yes |\n"
        "| `base` | time | - | yes |\n"),
    "src/base/CMakeLists.txt": "stator_room(base\n  SOURCES time.cpp)\n",
    "src/base/time.hpp": "#pragma once\n#include <cstdint>\n",
    "src/control/CMakeLists.txt": "stator_room(control\n  SOURCES loop.cpp\n  USES base)\n",
    "src/control/loop.cpp": '#include "base/time.hpp"\n',
    "src/drive/CMakeLists.txt": "stator_room(drive\n  SOURCES axis.cpp\n  USES base)\n",
    "src/drive/axis.cpp": '#include "base/time.hpp"\n',
    "src/link/CMakeLists.txt": "stator_room(link\n  SOURCES raw.cpp\n  USES base)\n",
    "src/link/raw.cpp": '#include <sys/socket.h>\n\n#include "base/time.hpp"\n',
}


class CheckLayering(unittest.TestCase):
    def violations(self, changes=None):
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, {**GOOD_TREE, **(changes or {})})
            return [str(v) for v in check_layering.check_tree(Path(root))]

    def assert_one(self, violations, *parts):
        self.assertEqual(len(violations), 1, violations)
        for part in parts:
            self.assertIn(part, violations[0])

    def test_a_tree_that_keeps_the_rules_passes(self):
        self.assertEqual(self.violations(), [])

    def test_an_include_of_a_room_above_is_found_with_its_line(self):
        self.assert_one(self.violations({"src/base/time.hpp": '\n#include "control/loop.hpp"\n'}),
                        "src/base/time.hpp:2: include:", "base may not use control")

    def test_an_include_in_angle_brackets_is_seen_too(self):
        self.assert_one(self.violations({"src/control/loop.cpp": "#include <drive/axis.hpp>\n"}),
                        "control may not use drive")

    def test_a_room_the_table_allows_must_stand_in_the_uses_list(self):
        self.assert_one(self.violations({"src/drive/axis.cpp": '#include "control/loop.hpp"\n'}),
                        "src/drive/axis.cpp:1: include:", "not in the USES list of drive")

    def test_a_uses_list_may_not_name_more_than_the_table(self):
        lists = "stator_room(control\n  SOURCES loop.cpp\n  USES\n    base\n    link)\n"
        self.assert_one(self.violations({"src/control/CMakeLists.txt": lists}),
                        "src/control/CMakeLists.txt:5: uses:", "control may not use link")

    def test_an_arrow_that_points_up_in_the_table_is_found(self):
        table = GOOD_TREE["docs/architecture.md"].replace(
            "| `control` | loops | `base` |", "| `control` | loops | `base`, `drive` |")
        self.assert_one(self.violations({"docs/architecture.md": table}),
                        "docs/architecture.md:5: table:", "drive, which stands above it")

    def test_a_room_without_a_row_is_found(self):
        self.assert_one(self.violations({"src/extra/a.cpp": "\n"}), "src/extra:1: table:")

    def test_a_document_without_a_table_is_not_taken_for_permission(self):
        self.assert_one(self.violations({"docs/architecture.md": "text\n"}), "no table of rooms")

    def test_a_room_without_a_declaration_is_found(self):
        self.assert_one(self.violations({"src/drive/CMakeLists.txt": "\n"}),
                        "src/drive/CMakeLists.txt:1: uses:")

    def test_system_headers_are_refused_in_a_portable_room(self):
        for header in ("thread", "chrono", "mutex", "sys/socket.h", "unistd.h", "iostream",
                       "fstream", "random", "linux/if.h", "cstdio"):
            with self.subTest(header):
                self.assert_one(self.violations({"src/drive/axis.cpp": f"#include <{header}>\n"}),
                                "src/drive/axis.cpp:1: portable:", f"<{header}>")

    def test_libm_functions_are_refused_in_a_portable_room(self):
        for call in ("std::sin(x)", "std::atan2(y, x)", "cosf(x)", "std::pow (x, 2)", "sqrt(exp(x))"):
            with self.subTest(call):
                self.assert_one(self.violations({"src/control/loop.cpp": f"\ndouble y = {call};\n"}),
                                "src/control/loop.cpp:2: portable:", "libm")

    def test_names_that_only_resemble_libm_functions_pass(self):
        text = "double a = std::sqrt(x) + sine_cosine(x).sine + motor.log(x) + curve::exp(x);\n"
        self.assertEqual(self.violations({"src/control/loop.cpp": text}), [])

    def test_clocks_and_unseeded_randomness_are_refused_without_their_headers(self):
        for name in ("std::chrono::steady_clock::now()", "std::random_device()", "rand()",
                     "std::this_thread::yield()"):
            with self.subTest(name):
                self.assert_one(self.violations({"src/base/time.hpp": f"auto t = {name};\n"}),
                                "src/base/time.hpp:1: portable:")

    def test_comments_and_texts_are_not_code(self):
        text = ('// std::sin(x) would differ\n/* #include "link/raw.hpp"\n std::thread */\n'
                'auto a = "std::sin(x)"; auto b = R"(std::cout "and" rand())"; int c = 1\'000;\n')
        self.assertEqual(self.violations({"src/control/loop.cpp": text}), [])

    def test_code_between_digit_separators_is_still_code(self):
        text = "auto a = 1'000; auto b = std::sin(a); auto c = 2'000;\n"
        self.assert_one(self.violations({"src/control/loop.cpp": text}), "std::sin")

    def test_the_exit_status_tells(self):
        for changes, status in (({}, 0), ({"src/base/time.hpp": "#include <thread>\n"}, 1)):
            with self.subTest(status), tempfile.TemporaryDirectory() as root:
                write_tree(root, {**GOOD_TREE, **changes})
                with mock.patch("sys.argv", ["check_layering.py", root]), \
                        contextlib.redirect_stdout(io.StringIO()), \
                        contextlib.redirect_stderr(io.StringIO()):
                    self.assertEqual(check_layering.main(), status)


if __name__ == "__main__":
    unittest.main()
