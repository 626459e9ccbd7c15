import tempfile
import unittest
from pathlib import Path

from loading import load, write_tree

check_conformance = load("check_conformance")

HEADER = "id,status,tests,note\n"
GOOD_ROWS = (
    "R-001,done,Axis.Moves;AxisTest.Stops,\n"
    'R-002,simplified,Axis.Moves,"no backlash, the gear is stiff"\n'
    "R-003,left-out,,needs a camera\n"
)
GOOD_TREE = {
    "docs/conformance/drive.csv": HEADER + GOOD_ROWS,
    "tests/data/drive/requirements.csv": 'id,requirement\nR-001,moves\nR-002,"a, b"\nR-003,sees\n',
    "tests/drive/axis_test.cpp": "TEST(Axis, Moves) {}\nTEST_F(\n    AxisTest,\n    Stops) {}\n",
}


class CheckConformance(unittest.TestCase):
    def errors(self, rows=GOOD_ROWS, changes=None):
        with tempfile.TemporaryDirectory() as root:
            tree = {**GOOD_TREE, "docs/conformance/drive.csv": HEADER + rows, **(changes or {})}
            write_tree(root, {path: text for path, text in tree.items() if text is not None})
            return list(check_conformance.check_tree(Path(root)))

    def assert_one(self, errors, *parts):
        self.assertEqual(len(errors), 1, errors)
        for part in parts:
            self.assertIn(part, errors[0])

    def test_a_complete_file_passes(self):
        self.assertEqual(self.errors(), [])

    def test_an_unknown_status_is_found_with_its_line(self):
        self.assert_one(
            self.errors(GOOD_ROWS.replace("R-001,done", "R-001,finished")),
            "docs/conformance/drive.csv:2:",
            "R-001",
            "'finished'",
        )

    def test_done_without_a_test_is_found(self):
        self.assert_one(self.errors(GOOD_ROWS.replace("Axis.Moves;AxisTest.Stops", "")), "R-001", "no test is named")

    def test_a_test_that_does_not_exist_is_found(self):
        self.assert_one(self.errors(GOOD_ROWS.replace("AxisTest.Stops", "AxisTest.Flies")), "no test AxisTest.Flies")

    def test_simplified_and_left_out_need_a_note(self):
        self.assert_one(
            self.errors(GOOD_ROWS.replace('"no backlash, the gear is stiff"', "")), "R-002", "without a note"
        )
        self.assert_one(self.errors(GOOD_ROWS.replace("needs a camera", " ")), "R-003", "without a note")

    def test_what_is_to_come_is_open_and_says_what_is_missing(self):
        rows = GOOD_ROWS.replace("left-out,,needs a camera", "open,,the camera is missing")
        self.assertEqual(self.errors(rows), [])
        self.assert_one(self.errors(rows.replace("the camera is missing", "")), "R-003", "without a note")

    def test_a_requirement_without_a_row_is_found(self):
        self.assert_one(self.errors(GOOD_ROWS.replace("R-003,left-out,,needs a camera\n", "")), "R-003: has no row")

    def test_a_row_that_is_no_requirement_is_found(self):
        self.assert_one(
            self.errors(GOOD_ROWS + "R-004,left-out,,unknown\n"), "drive.csv:5:", "R-004: is no requirement"
        )

    def test_a_requirement_with_two_rows_is_found(self):
        self.assert_one(self.errors(GOOD_ROWS + "R-003,left-out,,again\n"), "already in line 4")

    def test_a_row_with_an_unquoted_comma_is_found(self):
        rows = GOOD_ROWS.replace("needs a camera", "needs a camera, and light")
        self.assert_one([e for e in self.errors(rows) if "has no row" not in e], "not four columns")

    def test_other_columns_are_refused(self):
        errors = self.errors(changes={"docs/conformance/drive.csv": "id,state\nR-001,done\n"})
        self.assert_one(errors, "columns are")

    def test_a_device_without_its_list_of_requirements_is_found(self):
        self.assert_one(
            self.errors(changes={"tests/data/drive/requirements.csv": None}), "no tests/data/drive/requirements.csv"
        )

    def test_a_list_of_requirements_without_a_file_is_found(self):
        self.assert_one(self.errors(changes={"docs/conformance/drive.csv": None}), "missing")


if __name__ == "__main__":
    unittest.main()
