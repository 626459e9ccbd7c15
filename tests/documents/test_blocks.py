"""Tests of how documents are read, and of how output is compared."""

import unittest

import blocks


def steps(text):
    """Kind and text of each step of a document."""
    return [(step.kind, step.text) for step in blocks.read(text)]


class Reading(unittest.TestCase):
    def test_commands_go_on_behind_a_backslash_and_remarks_are_none(self):
        self.assertEqual(
            steps("```sh\n# first\nls \\\n  -l   # all\n\npwd\n```\n"),
            [("command", "ls \\\n  -l   # all"), ("command", "pwd")],
        )

    def test_commands_that_would_not_be_run_are_a_mistake(self):
        for text in ("```bash\nls\n```\n", "```console\n$ ls\n```\n", "Text:\n\n    stator devices\n", "    $ ls\n"):
            with self.assertRaisesRegex(blocks.Mistake, "blocks of sh"):
                blocks.read(text)
        self.assertEqual(steps("Text:\n\n    stator: this is what it says\n"), [])

    def test_each_step_knows_its_line(self):
        self.assertEqual(
            [step.line for step in blocks.read("A\n\n```sh\none\ntwo\n```\n<!-- run: three -->\n")], [4, 5, 7]
        )

    def test_blocks_of_other_languages_are_not_run(self):
        self.assertEqual(steps("```toml\na = 1\n```\n```text\nls\n```\n"), [])

    def test_what_is_left_out_has_a_reason(self):
        self.assertEqual(steps("<!-- not run: no display -->\n\n```sh\nls\n```\n"), [("left out", "no display")])
        with self.assertRaisesRegex(blocks.Mistake, "not why"):
            blocks.read("<!-- not run: -->\n\n```sh\nls\n```\n")

    def test_single_lines_are_left_out_by_their_beginning(self):
        self.assertEqual(
            steps("<!-- not run (slaveinfo, ec_): SOEM -->\n```sh\nls\nslaveinfo a\nec_sample a\n```\n"),
            [("command", "ls"), ("left out", "SOEM"), ("left out", "SOEM")],
        )

    def test_a_note_for_a_line_that_does_not_exist_is_a_mistake(self):
        with self.assertRaisesRegex(blocks.Mistake, "begins with 'pwd'"):
            blocks.read("<!-- fails (pwd) -->\n```sh\nls\n```\n")

    def test_a_note_without_a_block_is_a_mistake(self):
        with self.assertRaisesRegex(blocks.Mistake, "for a block"):
            blocks.read("<!-- output -->\n\nText.\n\n```text\nls\n```\n")

    def test_a_note_of_unknown_form_is_a_mistake_and_other_comments_are_none(self):
        with self.assertRaisesRegex(blocks.Mistake, "no note of that form"):
            blocks.read("<!-- not run (ls: why -->\n```sh\nls\n```\n")
        self.assertEqual(steps("<!-- end of conformance -->\n```sh\nls\n```\n"), [("command", "ls")])

    def test_a_rack_that_is_run_stays_and_what_has_an_ampersand(self):
        def stays(command):
            return blocks.read(f"```sh\n{command}\n```\n")[0].stays

        for command in (
            "stator run racks/gantry.toml   # a rack",
            "sudo build/release/src/cli/stator run --device tmcm-3315",
            "sudo ip netns exec slaves stator run rack.toml",
            "$stator run rack.toml",
            "cat fifo &",
        ):
            self.assertTrue(stays(command), command)
        for command in ("stator run --help", "stator tmcl run turns.tmc", "ls && pwd", "stator test runs"):
            self.assertFalse(stays(command), command)

    def test_a_transcript_has_commands_and_their_output(self):
        self.assertEqual(
            steps("```text\n$ ls\na\nb\n$ pwd\n/\n```\n"),
            [("command", "ls"), ("output", "a\nb"), ("command", "pwd"), ("output", "/")],
        )

    def test_a_dialogue_is_typed_behind_its_prompts(self):
        (step,) = blocks.read("```text\n$ stator tmcl shell\ntmcl> version\n142\ntmcl> status\nstopped\n```\n")
        self.assertEqual((step.kind, step.text), ("dialogue", "stator tmcl shell"))
        self.assertEqual(blocks.dialogue(step.content), (["version", "status"], "142\nstopped"))

    def test_files_have_the_lines_of_their_block(self):
        (step,) = blocks.read("1. Item\n\n   <!-- file: a.toml -->\n   ```toml\n   a = 1\n   ```\n")
        self.assertEqual((step.kind, step.text, step.content), ("file", "a.toml", "a = 1\n"))

    def test_hidden_commands_are_one_for_each_line(self):
        self.assertEqual(steps("<!-- run:\nls\npwd\n-->\n"), [("command", "ls"), ("command", "pwd")])
        self.assertFalse(any(step.shown for step in blocks.read("<!-- run: ls -->\n")))

    def test_heads_of_racks_have_commands_and_cables(self):
        text = (
            "# A rack.\n#\n#   stator run a.toml --link ethercat:eth1\n#   stator move --link udp:a\n\n#   stator x\n"
        )
        self.assertEqual(
            [(step.line, step.text, step.stays) for step in blocks.read_head(text)],
            [
                (1, "cable eth1 eth1-end", False),
                (3, "stator run a.toml --link ethercat:eth1", True),
                (4, "stator move --link udp:a", True),
            ],
        )

    def test_commands_in_the_text_are_found_with_their_lines(self):
        text = "Text `stator run\n--http`, ``x``.\n\n```sh\n`stator devices`\n```\n`stator devices`\n"
        self.assertEqual(blocks.in_text(text), [(1, "stator run --http"), (7, "stator devices")])

    def test_what_only_tells_is_run_when_it_is_whole(self):
        for command in ("stator devices", "stator describe tmcc160 --inputs", "stator check --keys", "stator faults"):
            self.assertTrue(blocks.tells(command), command)
        for command in (
            "stator describe DEVICE --inputs",
            "stator export eds",
            "stator run --http",
            "stator test a.toml",
        ):
            self.assertFalse(blocks.tells(command), command)


class Comparing(unittest.TestCase):
    def same(self, expected, output, varying=()):
        self.assertIsNone(blocks.difference(expected, output, varying))

    def other(self, expected, output, varying=()):
        self.assertIsNotNone(blocks.difference(expected, output, varying))

    def test_all_lines_have_to_be_there_in_their_order(self):
        self.same("a\nb", "a\nb\n")
        self.other("a\nb", "a\n")
        self.other("a\nb", "b\na\n")
        self.other("a", "a\nb\n")
        self.other("b", "a\nb\n")
        self.other("a", "")

    def test_numbers_of_blanks_do_not_matter(self):
        self.same("a  b", " a b  \n")
        self.other("a b", "ab\n")

    def test_an_ellipsis_alone_is_any_lines(self):
        for output in ("a\nb\n", "a\nx\nb\n", "a\nb\nx\nb\n"):
            self.same("a\n...\nb", output)
        self.same("...\nb", "x\nb\n")
        self.same("a\n...", "a\nx\n")
        self.same("...\nb\n...", "x\nb\ny\n")
        self.other("a\n...\nb", "a\nb\nx\n")
        self.other("...\nb\n...", "x\ny\n")
        self.other("...\nb\n...\na\n...", "a\nb\n")

    def test_lines_between_ellipses_stand_together(self):
        self.same("...\na\nb\n...", "a\nx\na\nb\nc\n")
        self.other("...\na\nb\n...", "a\nx\nb\n")

    def test_an_ellipsis_within_a_line_is_a_part_of_it(self):
        self.same("at ... s: done", "at 0.5 s: done")
        self.other("at ... s: done", "at 0.5 s: failed")

    def test_texts_that_vary_may_be_any_word(self):
        self.same("in 0.01 s", "in 12.5 s", ["0.01"])
        self.other("in 0.01 s", "in 1 or 2 s", ["0.01"])
        self.other("in 0.01 s", "in 12.5 s")


if __name__ == "__main__":
    unittest.main()
