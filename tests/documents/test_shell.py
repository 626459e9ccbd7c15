"""Tests of the shell that does what documents say."""

import os
import tempfile
import unittest

from shell import Failed, Shell


class Commands(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="stator-documents-")
        self.addCleanup(directory.cleanup)
        os.mkdir(os.path.join(directory.name, "notes"))
        self.shell = Shell(directory.name, dict(os.environ), os.path.join(directory.name, "notes"))
        self.addCleanup(self.shell.close)

    def test_status_and_output_are_those_of_the_command(self):
        self.assertEqual(self.shell.run("echo out; echo error >&2; false"), (1, "out\nerror\n"))

    def test_a_line_that_is_no_command_leaves_the_shell_alive(self):
        self.assertEqual(self.shell.run("if (")[0], 2)
        self.assertEqual(self.shell.run("echo alive"), (0, "alive\n"))

    def test_variables_and_folder_are_kept(self):
        self.shell.run("mkdir inner; cd inner; word=kept")
        status, output = self.shell.run("echo $word; basename $PWD")
        self.assertEqual((status, output), (0, "kept\ninner\n"))

    def test_typed_lines_are_read(self):
        self.assertEqual(self.shell.run("cat", "one\ntwo\n"), (0, "one\ntwo\n"))
        self.assertEqual(self.shell.run("cat"), (0, ""))

    def test_what_stays_is_ended_as_by_control_c(self):
        started = self.shell.start("trap 'echo ended; exit 0' INT; echo Ready; while :; do sleep 0.01; done", "Ready")
        self.shell.stop()
        self.assertEqual(started.output(), "Ready\nended\n")

    def test_what_ends_badly_fails(self):
        self.shell.start("trap 'exit 3' INT; echo Ready; while :; do sleep 0.01; done", "Ready")
        with self.assertRaisesRegex(Failed, "status 3"):
            self.shell.stop()

    def test_what_ends_before_it_is_ready_fails(self):
        with self.assertRaisesRegex(Failed, "has ended:\nno link"):
            self.shell.start("echo no link; false", "Ready")


if __name__ == "__main__":
    unittest.main()
