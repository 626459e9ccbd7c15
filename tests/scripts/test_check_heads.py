import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from loading import load, write_tree

check_heads = load("check_heads")

GOOD_TREE = {
    "src/stator/base/time.hpp": "#pragma once\n\nnamespace stator::base {\n\n/// A time.\nclass SimTime {};\n}\n",
    "src/stator/base/time.cpp": '#include "stator/base/time.hpp"\n\nint value = 0;\n',
    "src/stator/main.cpp": "// The program.\n#include <vector>\n\nint main() {}\n",
    "clients/c/chip.h": "/* A chip. */\n#ifndef CHIP_H\n#define CHIP_H\n#endif\n",
    "clients/c/chip.c": '#include "chip.h"\n\nint chip;\n',
    "tests/base/notes.md": "text\n",
}


class CheckHeads(unittest.TestCase):
    def files(self, changes=None):
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, {**GOOD_TREE, **(changes or {})})
            return [path.as_posix() for path in check_heads.files_without_head(Path(root))]

    def test_files_with_a_head_pass(self):
        self.assertEqual(self.files(), [])

    def test_a_header_and_a_source_without_a_header_must_have_one(self):
        for path in (
            "src/stator/base/room.hpp",
            "src/stator/cli/run.cpp",
            "tests/base/time_test.cpp",
            "fuzz/fuzz_rack.cpp",
            "benchmarks/ramp.cpp",
            "examples/c/slave.c",
            "clients/c/connect.h",
        ):
            with self.subTest(path):
                self.assertEqual(self.files({path: "#include <vector>\n\nint value = 0;\n"}), [path])

    def test_a_header_of_the_same_name_must_stand_beside_its_source(self):
        self.assertEqual(self.files({"src/stator/cli/time.cpp": "int value = 0;\n"}), ["src/stator/cli/time.cpp"])

    def test_other_folders_are_not_looked_at(self):
        self.assertEqual(self.files({"build/a.cpp": "int value = 0;\n"}), [])

    def test_what_may_stand_above_a_head(self):
        for above in (
            "#pragma once\n#include <vector>  // for all\n",
            "#define TWICE(x) \\\n  x, x\n",
            "namespace stator {\nnamespace {\n",
            "inline namespace literals {  // of units\n",
            "using namespace base::literals;\nusing Map =\n    std::map<int, int>;\n",
            'extern "C" {\n',
            "class Device;\nstruct Frame;  // its own header\nenum class Kind : std::uint8_t;\n",
            "template <typename Signature>\nclass Delegate;\n",
            "namespace stator::base {\nclass Other;\n}  // namespace stator::base\nnamespace own {\n",
        ):
            for head in ("/// A device.\n", "// A device.\n", "/* A device. */\n"):
                with self.subTest(above + head):
                    self.assertTrue(check_heads.has_head(above + head + "int value = 0;\n"))
            with self.subTest(above):
                self.assertFalse(check_heads.has_head(above + "int value = 0;  // a number\n"))

    def test_definitions_are_no_forward_declarations(self):
        for first in ("struct Frame {\n", "class Drive : public Device {\n", "enum class Kind : std::uint8_t { a };\n"):
            with self.subTest(first):
                self.assertFalse(check_heads.has_head(first + "// A member.\nint value = 0;\n};\n"))

    def test_a_comment_for_a_tool_is_no_head(self):
        for comment in ("// NOLINTBEGIN(misc-include-cleaner)\n", "// clang-format off\n"):
            with self.subTest(comment):
                self.assertFalse(check_heads.has_head(comment + "int value = 0;\n"))
                self.assertTrue(check_heads.has_head(comment + "// A number.\nint value = 0;\n"))

    def test_an_empty_file_has_none(self):
        self.assertFalse(check_heads.has_head("\n"))

    def test_each_file_is_named_with_what_to_do_and_the_exit_status_tells(self):
        for changes, status in (({}, 0), ({"tests/base/time_test.cpp": "int value = 0;\n"}, 1)):
            with self.subTest(status), tempfile.TemporaryDirectory() as root:
                write_tree(root, {**GOOD_TREE, **changes})
                errors = io.StringIO()
                with (
                    mock.patch("sys.argv", ["check_heads.py", root]),
                    contextlib.redirect_stdout(io.StringIO()),
                    contextlib.redirect_stderr(errors),
                ):
                    self.assertEqual(check_heads.main(), status)
                for path in changes:
                    self.assertIn(f"{path}: head: ", errors.getvalue())
                    self.assertIn("one sentence", errors.getvalue())


if __name__ == "__main__":
    unittest.main()
