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
        "| `rack`: run, core, world | racks | `base` | no |\n"
        "| `drive` | axes | `control`, `base` | yes |\n"
        "| `control` | loops | `base` | yes |\n"
        "| `base` | time | - | yes |\n"
    ),
    "src/stator/base/CMakeLists.txt": "stator_room(base\n  SOURCES time.cpp)\n",
    "src/stator/base/time.hpp": "#pragma once\n#include <cstdint>\n",
    "src/stator/control/CMakeLists.txt": "stator_room(control\n  SOURCES loop.cpp\n  USES base)\n",
    "src/stator/control/loop.cpp": '#include "stator/base/time.hpp"\n',
    "src/stator/drive/CMakeLists.txt": "stator_room(drive\n  SOURCES axis.cpp\n  USES base)\n",
    "src/stator/drive/axis.cpp": '#include "stator/base/time.hpp"\n',
    "src/stator/link/CMakeLists.txt": "stator_room(link\n  SOURCES raw.cpp\n  USES base)\n",
    "src/stator/rack/CMakeLists.txt": "stator_room(rack\n  SOURCES core/rack.cpp\n  USES base)\n",
    "src/stator/rack/run/runner.cpp": '#include "stator/rack/core/rack.hpp"\n#include "stator/rack/text.hpp"\n',
    "src/stator/rack/core/rack.hpp": '#include "stator/rack/world/clock.hpp"\n',
    "src/stator/rack/core/rack.cpp": '#include "stator/rack/core/internal/parts.hpp"\n',
    "src/stator/rack/core/internal/parts.hpp": '#include "stator/rack/core/internal/part.hpp"\n',
    "src/stator/rack/core/internal/part.hpp": "\n",
    "src/stator/rack/world/clock.hpp": '#include "stator/base/time.hpp"\n',
    "src/stator/rack/text.hpp": "\n",
    "src/stator/link/raw.cpp": '#include <sys/socket.h>\n\n#include "stator/base/time.hpp"\n',
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
        self.assert_one(
            self.violations({"src/stator/base/time.hpp": '\n#include "stator/control/loop.hpp"\n'}),
            "src/stator/base/time.hpp:2: include:",
            "base may not use control",
        )

    def test_an_include_in_angle_brackets_is_seen_too(self):
        self.assert_one(
            self.violations({"src/stator/control/loop.cpp": "#include <stator/drive/axis.hpp>\n"}),
            "control may not use drive",
        )

    def test_a_room_the_table_allows_must_stand_in_the_uses_list(self):
        self.assert_one(
            self.violations({"src/stator/drive/axis.cpp": '#include "stator/control/loop.hpp"\n'}),
            "src/stator/drive/axis.cpp:1: include:",
            "not in the USES list of drive",
        )

    def test_a_uses_list_may_not_name_more_than_the_table(self):
        lists = "stator_room(control\n  SOURCES loop.cpp\n  USES\n    base\n    link)\n"
        self.assert_one(
            self.violations({"src/stator/control/CMakeLists.txt": lists}),
            "src/stator/control/CMakeLists.txt:5: uses:",
            "control may not use link",
        )

    def test_an_arrow_that_points_up_in_the_table_is_found(self):
        table = GOOD_TREE["docs/architecture.md"].replace(
            "| `control` | loops | `base` |", "| `control` | loops | `base`, `drive` |"
        )
        self.assert_one(
            self.violations({"docs/architecture.md": table}),
            "docs/architecture.md:6: table:",
            "drive, which stands above it",
        )

    def test_a_room_without_a_row_is_found(self):
        self.assert_one(self.violations({"src/stator/extra/a.cpp": "\n"}), "src/stator/extra:1: table:")

    def test_a_document_without_a_table_is_not_taken_for_permission(self):
        self.assert_one(self.violations({"docs/architecture.md": "text\n"}), "no table of rooms")

    def test_a_room_without_a_declaration_is_found(self):
        self.assert_one(
            self.violations({"src/stator/drive/CMakeLists.txt": "\n"}), "src/stator/drive/CMakeLists.txt:1: uses:"
        )

    def test_an_include_without_the_prefix_is_found(self):
        self.assert_one(
            self.violations({"src/stator/drive/axis.cpp": '#include "base/time.hpp"\n'}),
            "src/stator/drive/axis.cpp:1: include:",
            'write "stator/base/time.hpp"',
        )

    def test_an_include_that_names_no_room_is_found(self):
        for header, remedy in (
            ("time.hpp", 'write "stator/drive/time.hpp"'),
            ("stator/bench.hpp", "names no room"),
            ("stator/extra/a.hpp", "names no room"),
        ):
            with self.subTest(header):
                self.assert_one(
                    self.violations({"src/stator/drive/axis.cpp": f'#include "{header}"\n'}),
                    "src/stator/drive/axis.cpp:1: include:",
                    remedy,
                )

    def test_a_header_without_its_room_is_told_its_folder(self):
        self.assert_one(
            self.violations({"src/stator/rack/run/runner.cpp": '#include "task_queue.hpp"\n'}),
            'write "stator/rack/run/task_queue.hpp"',
        )

    def test_an_include_of_a_folder_above_is_found(self):
        self.assert_one(
            self.violations({"src/stator/rack/world/clock.hpp": '#include "stator/rack/core/rack.hpp"\n'}),
            "src/stator/rack/world/clock.hpp:1: folder:",
            "world may not include",
            "core stands above it in the row of rack",
        )

    def test_the_room_itself_is_below_its_folders(self):
        self.assert_one(
            self.violations({"src/stator/rack/text.hpp": '#include "stator/rack/world/clock.hpp"\n'}),
            "src/stator/rack/text.hpp:1: folder:",
            "rack itself may not include",
        )

    def test_a_folder_that_the_row_does_not_name_is_found(self):
        self.assert_one(
            self.violations({"src/stator/rack/kept/file.hpp": "\n"}),
            "src/stator/rack/kept:1: table:",
            "does not name the folder kept",
        )

    def test_a_folder_that_only_the_row_names_is_found(self):
        table = GOOD_TREE["docs/architecture.md"].replace("run, core, world", "run, core, kept, world")
        self.assert_one(
            self.violations({"docs/architecture.md": table}),
            "docs/architecture.md:4: table:",
            "rack has no folder kept",
        )

    def test_a_folder_in_a_folder_is_found(self):
        self.assert_one(
            self.violations({"src/stator/rack/core/parts/part.hpp": "\n"}),
            "src/stator/rack/core/parts:1: table:",
            "a folder of a folder",
        )

    def test_a_folder_of_too_many_files_is_found(self):
        files = {f"src/stator/rack/run/tasks_{number}.hpp": "\n" for number in range(40)}
        self.assert_one(self.violations(files), "src/stator/rack/run:1: size:", "41 files")

    def test_internal_headers_are_for_their_folder_only(self):
        include = '#include "stator/rack/core/internal/part.hpp"\n'
        self.assert_one(
            self.violations({"src/stator/rack/run/runner.cpp": include}),
            "src/stator/rack/run/runner.cpp:1: internal:",
            "internal to stator/rack/core",
        )

    def test_internal_headers_of_a_room_are_not_for_its_folders(self):
        changes = {
            "src/stator/base/internal/table.hpp": "\n",
            "src/stator/base/time.hpp": '#include "stator/base/internal/table.hpp"\n',
        }
        self.assertEqual(self.violations(changes), [])
        changes["src/stator/link/raw.cpp"] = '#include "stator/base/internal/table.hpp"\n'
        self.assert_one(self.violations(changes), "src/stator/link/raw.cpp:1: internal:")

    def test_system_headers_are_refused_in_a_portable_room(self):
        for header in (
            "thread",
            "chrono",
            "mutex",
            "sys/socket.h",
            "unistd.h",
            "iostream",
            "fstream",
            "random",
            "linux/if.h",
            "cstdio",
        ):
            with self.subTest(header):
                self.assert_one(
                    self.violations({"src/stator/drive/axis.cpp": f"#include <{header}>\n"}),
                    "src/stator/drive/axis.cpp:1: portable:",
                    f"<{header}>",
                )

    def test_headers_for_users_include_each_other_and_rooms_of_the_library(self):
        face = {
            "src/stator/motion.hpp": '#include "stator/control/loop.hpp"\n#include "stator/version.hpp"\n',
            "src/stator/version.hpp": "#pragma once\n",
        }
        self.assertEqual(self.violations(face), [])
        for header, text in (
            ("stator/nothing/x.hpp", "names no room"),
            ("stator/none.hpp", "does not exist"),
            ("stator/link/raw.hpp", "not installed"),
            ("stator/rack/core/internal/part.hpp", "internal"),
        ):
            with self.subTest(header):
                wrong = {
                    **face,
                    "src/stator/motion.hpp": f'\n#include "{header}"\n',
                    "src/stator/link/CMakeLists.txt": "stator_room(link PROGRAM\n  SOURCES raw.cpp\n  USES base)\n",
                }
                self.assert_one(self.violations(wrong), "src/stator/motion.hpp:2: face:", text)

    def test_no_room_includes_a_header_for_users(self):
        self.assert_one(
            self.violations({"src/stator/drive/axis.cpp": '#include "stator/motion.hpp"\n'}),
            "src/stator/drive/axis.cpp:1: include:",
            "for users of the library",
        )

    def test_libm_functions_are_refused_in_a_portable_room(self):
        for call in ("std::sin(x)", "std::atan2(y, x)", "cosf(x)", "std::pow (x, 2)", "sqrt(exp(x))"):
            with self.subTest(call):
                self.assert_one(
                    self.violations({"src/stator/control/loop.cpp": f"\ndouble y = {call};\n"}),
                    "src/stator/control/loop.cpp:2: portable:",
                    "libm",
                )

    def test_names_that_only_resemble_libm_functions_pass(self):
        text = "double a = std::sqrt(x) + sine_cosine(x).sine + motor.log(x) + curve::exp(x);\n"
        self.assertEqual(self.violations({"src/stator/control/loop.cpp": text}), [])

    def test_clocks_and_unseeded_randomness_are_refused_without_their_headers(self):
        for name in ("std::chrono::steady_clock::now()", "std::random_device()", "rand()", "std::this_thread::yield()"):
            with self.subTest(name):
                self.assert_one(
                    self.violations({"src/stator/base/time.hpp": f"auto t = {name};\n"}),
                    "src/stator/base/time.hpp:1: portable:",
                )

    def test_comments_and_texts_are_not_code(self):
        text = (
            '// std::sin(x) would differ\n/* #include "stator/link/raw.hpp"\n std::thread */\n'
            'auto a = "std::sin(x)"; auto b = R"(std::cout "and" rand())"; int c = 1\'000;\n'
        )
        self.assertEqual(self.violations({"src/stator/control/loop.cpp": text}), [])

    def test_code_between_digit_separators_is_still_code(self):
        text = "auto a = 1'000; auto b = std::sin(a); auto c = 2'000;\n"
        self.assert_one(self.violations({"src/stator/control/loop.cpp": text}), "std::sin")

    def test_the_exit_status_tells(self):
        for changes, status in (({}, 0), ({"src/stator/base/time.hpp": "#include <thread>\n"}, 1)):
            with self.subTest(status), tempfile.TemporaryDirectory() as root:
                write_tree(root, {**GOOD_TREE, **changes})
                with (
                    mock.patch("sys.argv", ["check_layering.py", root]),
                    contextlib.redirect_stdout(io.StringIO()),
                    contextlib.redirect_stderr(io.StringIO()),
                ):
                    self.assertEqual(check_layering.main(), status)


if __name__ == "__main__":
    unittest.main()
