"""docs/reference is what the program says of itself, and a page that is not is named: run by ctest with the program."""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop()).resolve()
sys.path.insert(0, str(ROOT / "scripts/docs"))
import reference  # noqa: E402


class Reference(unittest.TestCase):
    def test_is_what_the_program_says(self):
        self.assertEqual(reference.stale(reference.pages(PROGRAM), ROOT / "docs/reference"), [],
                         "run scripts/docs/reference.py build/release/eval/mosbench")

    def test_has_every_name(self):
        written = reference.pages(PROGRAM)
        for page, heading in (("commands.md", "## map"), ("settings.md", "### dynablox"), ("settings.md", "### kiss"),
                              ("protocols.md", "## mapmos"), ("formats.md", "### semantickitti")):
            self.assertIn(f"\n{heading}\n", written[page])

    def test_a_page_that_differs_or_is_left_over_or_absent_is_named(self):
        with tempfile.TemporaryDirectory() as name:
            for page in ("same", "old", "left_over"):
                pathlib.Path(name, f"{page}.md").write_text(page)
            self.assertEqual(reference.stale({"same.md": "same", "old.md": "new", "absent.md": ""}, pathlib.Path(name)),
                             ["absent.md", "left_over.md", "old.md"])

    def test_cells_keep_what_markdown_would_take(self):
        self.assertEqual(reference.table(["a"], [["x|<b>"], [True], [None], [-16.61111], [1000000.0]]),
                         "| a |\n| --- |\n| x\\|\\<b> |\n| yes |\n|  |\n| -16.61111 |\n| 1000000 |\n")


if __name__ == "__main__":
    unittest.main()
