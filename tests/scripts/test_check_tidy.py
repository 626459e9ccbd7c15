import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from loading import load, write_tree

check_tidy = load("check_tidy")

TREE = {
    "src/stator/base/time.hpp": "",
    "src/stator/base/event.hpp": "",
    "src/stator/base/event.cpp": '#include "stator/base/event.hpp"\n',
    "src/stator/base/unused.hpp": "",
    "src/stator/base/span.hpp": "",
    "tests/base/clock.hpp": '#include "stator/base/span.hpp"\n',
    "tests/base/time_test.cpp": '#include "stator/base/time.hpp"\n#include "base/clock.hpp"\n',
}
COMPILED = {"src/stator/base/event.cpp", "tests/base/time_test.cpp"}


class SourcesToCheck(unittest.TestCase):
    def sources(self, files):
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, TREE)
            with mock.patch.object(check_tidy, "ROOT", Path(root)):
                return check_tidy.sources_to_check(files, COMPILED)

    def test_a_source_is_checked_itself(self):
        self.assertEqual(self.sources(["src/stator/base/event.cpp"]), (["src/stator/base/event.cpp"], []))

    def test_a_header_is_checked_through_the_source_of_its_name(self):
        self.assertEqual(self.sources(["src/stator/base/event.hpp"]), (["src/stator/base/event.cpp"], []))

    def test_a_header_alone_is_checked_through_a_source_that_includes_it(self):
        self.assertEqual(self.sources(["src/stator/base/time.hpp"]), (["tests/base/time_test.cpp"], []))

    def test_a_header_that_headers_include_is_checked_through_a_source_of_theirs(self):
        self.assertEqual(self.sources(["src/stator/base/span.hpp"]), (["tests/base/time_test.cpp"], []))

    def test_a_header_nobody_includes_is_named(self):
        self.assertEqual(self.sources(["src/stator/base/unused.hpp"]), ([], ["src/stator/base/unused.hpp"]))


class ChangedFiles(unittest.TestCase):
    def test_what_only_moved_is_no_change(self):
        moved = "// one\n// two\n// three\n// four\n// five\nint {};\n"
        before = {
            "src/a.cpp": '#include "a.hpp"\n' + moved.format("a"),
            "src/b.cpp": '#include "b.hpp"\n' + moved.format("b"),
            "src/c.cpp": "int c;\n",
        }
        after = {
            "src/x/a.cpp": '#include "x/a.hpp"\n' + moved.format("a"),
            "src/x/b.cpp": '#include "x/b.hpp"\n' + moved.format("changed"),
            "src/c.cpp": "int d;\n",
        }
        with tempfile.TemporaryDirectory() as root:

            def git(*arguments):
                subprocess.run(
                    ["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b", *arguments],
                    check=True,
                    stdout=subprocess.DEVNULL,
                )

            git("init", "--quiet")
            write_tree(root, before)
            git("add", "--all")
            git("commit", "--quiet", "--message", "before")
            for name in before:
                (Path(root) / name).unlink()
            write_tree(root, after)
            git("add", "--all")
            with mock.patch.object(check_tidy, "ROOT", Path(root)):
                self.assertEqual(check_tidy.changed_files("HEAD"), ["src/c.cpp", "src/x/b.cpp"])


if __name__ == "__main__":
    unittest.main()
