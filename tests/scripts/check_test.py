"""The checks of scripts/check refuse what they should, on texts made here: run by ctest."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts/check"))
import english  # noqa: E402
import headers  # noqa: E402
import includes  # noqa: E402
import mutants  # noqa: E402
import pages  # noqa: E402
import paper  # noqa: E402


class Paper(unittest.TestCase):
    def test_definitions_and_declarations_of_a_name_are_found(self):
        for text in ("struct Line {", "class Line final {", "enum class Line : int {", "using Line = int;",
                     "double Line(int x) {", "  std::vector<int> Line(int x) const;", "Line::Line(int x) : x_(x) {}",
                     "Pose* Ray::Line(double t) {", "inline const Pose& Line(int k) {"):
            self.assertTrue(paper.declares(text, "Line"), text)

    def test_a_mere_mention_is_no_declaration(self):
        for text in ("// Line (a comment)\nint x;", "struct Line;", "  return Line(3);", "x = Line(3);",
                     'throw Error("double Line(int)");', "else Line(2);", "double Lines(int);", "new Line(1);"):
            self.assertFalse(paper.declares(text, "Line"), text)

    def sentences(self, readme, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                (pathlib.Path(folder) / name).write_text(text)
            return paper.wrong_references(readme, pathlib.Path(folder)) + paper.wrong_definitions(readme)

    def readme(self, rows):
        table = "".join(f"| {row} |\n" for row in rows)
        return f"# core\n## The paper's definitions\n| section | fast |\n|---|---|\n{table}\n## Else\n"

    def test_a_whole_table_is_accepted(self):
        rows = ["Line | [`a.cpp:line`](a.cpp)"] * paper.DEFINITIONS
        files = {"a.cpp": "int line(int x) {"}
        self.assertEqual(self.sentences(self.readme(rows), files), [])
        count = paper.DEFINITIONS
        self.assertEqual(self.sentences(self.readme(rows[1:]), files),
                         [f"{count - 1} definitions of the paper, expected {count}"])

    def test_references_that_lead_nowhere_are_named(self):
        rows = ["Line | [`a.cpp:line`](a.cpp)"] * (paper.DEFINITIONS - 4) + [
            "Gone | [`b.cpp:line`](b.cpp)", "Renamed | [`a.cpp:ray`](a.cpp)", "Elsewhere | [`a.cpp:line`](c.cpp)",
            "None | see the code"]
        said = "\n".join(self.sentences(self.readme(rows), {"a.cpp": "int line(int x) {", "c.cpp": ""}))
        for expected in ("`b.cpp:line`: there is no such file", "`a.cpp:ray`: a.cpp declares no ray",
                         "`a.cpp:line` links to c.cpp", "no reference in: | None | see the code |"):
            self.assertIn(expected, said)


class English(unittest.TestCase):
    def test_of_the_project_is_plain(self):
        done = subprocess.run([ROOT / "scripts/check/english.py"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_long_sentences_are_named_with_their_place(self):
        long = "A word " + "and a word " * 8  # 26 words
        wrong = english.wrong_sentences("a.md", f"# T\n\nShort one.\n- {long}\n  ends. Short.\n")
        self.assertEqual(len(wrong), 1)
        self.assertRegex(wrong[0], "^a.md:4: 27 words, expected at most 25: A word .* ends.$")
        for whole in (f"```\n{long} word\n```\n", f"| {long} word |\n", f"`{long}` {long[:-5]}.\n", f"{long[:-5]}: {long[:-5]}.\n"):
            self.assertEqual(english.wrong_sentences("a.md", whole), [], whole)
        self.assertEqual(english.wrong_sentences("a.txt", f"Examples:\n  mosbench {long}\n---\nShort.\n"), [])

    def test_banned_phrases_are_named(self):
        for text, said in (("Points of which few move.", "of which"), ("Things are said here.", "are said"),
                           ("Yes. What moves is found.", "What ... is"), ("- Of two runs one is best.", "begins with Of")):
            self.assertRegex("".join(english.wrong_sentences("a.md", text)), said)
        self.assertEqual(english.wrong_sentences("a.md", "Say what is. Runs of two \"of which\" `of which`.\n"), [])

    @unittest.skipUnless(shutil.which("codespell"), "there is no codespell")
    def test_mistakes_of_spelling_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.cpp"
            file.write_text("// Returns the " + "rec" + "ieved" + " scan.\n")
            self.assertRegex("".join(english.misspelt([file])), "a.cpp:1: .* ==> received")


class Pages(unittest.TestCase):
    def test_of_the_project_are_right(self):
        done = subprocess.run([ROOT / "scripts/check/pages.py"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_links_that_lead_nowhere_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("# A `b`, c\n[a](#a-b-c) [b](page.md#a-b-c) [c](gone.md) [d](#d)\n```\n[e](e.md)\n```\n")
            self.assertEqual(pages.wrong_links(page), [f"{page}: gone.md: there is no such file",
                                                       f"{page}: #d: no heading is called so"])


    def test_that_are_too_long_are_named(self):
        long = "line\n" * 26
        self.assertEqual(pages.too_long({"README.md": long, "core/README.md": long, "docs/history/README.md": long}),
                         ["core/README.md: 26 lines, expected at most 25"])
        self.assertEqual(pages.too_long({"docs/a.md": "word " * 10501, "docs/history/b.md": "word " * 11500}),
                         ["docs without history: 10501 words, expected at most 10500",
                          "all pages: 22001 words, expected at most 22000"])
        self.assertEqual(pages.too_long({"docs/a.md": "word " * 10500, "docs/history/b.md": "word " * 11500,
                                         "docs/reference/c.md": "word " * 9000}), [])


class Headers(unittest.TestCase):
    def said_of(self, header, **others):
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.object(headers, "ROOT", pathlib.Path(folder)):
            headers.foreign.cache_clear()
            for name, text in {"h": header, **others}.items():
                (pathlib.Path(folder) / f"{name}.hpp").write_text(text)
            shared = [headers.precompile({name}, pathlib.Path(folder) / f"{name}_alone.hpp") for name in ("string", "vector")]
            return headers.complaint("h.hpp", shared)

    def test_a_header_that_includes_what_it_needs_is_accepted(self):
        self.assertEqual(self.said_of("#include <vector>\n\nstruct H {\n  std::vector<int> of;\n};\n"), "")

    def test_what_another_header_includes_counts(self):
        self.assertEqual(self.said_of('#include "a.hpp"\n\nextern std::string h;\n', a="#include <string>\n"), "")

    def test_a_header_that_needs_more_than_it_includes_is_refused(self):
        self.assertIn("vector", self.said_of("#include <cstdint>\n\nstruct H {\n  std::vector<int> of;\n};\n"))

    def test_an_include_after_something_else_is_refused(self):
        self.assertIn("h.hpp:2: an include after something else", self.said_of("struct H;\n#include <vector>\n"))


class Includes(unittest.TestCase):
    def test_each_room_has_its_name(self):
        self.assertEqual(includes.room_of("core/voxel/raycast.cpp"), "core/voxel")
        self.assertEqual(includes.room_of("core/methods/methods.cpp"), "core/methods")
        self.assertEqual(includes.room_of("core/include/mosbench/scan.hpp"), "core/include")
        self.assertEqual(includes.room_of("tests/unit/core/otsu_test.cpp"), "tests")

    def test_lower_rooms_may_be_included(self):
        for name, quote, header in (
                ("core/methods/hmm_mos/hmm.cpp", '"', "core/voxel/voxel.hpp"), ("core/voxel/raycast.cpp", "<", "vector"),
                ("eval/cli/run_command.cpp", "<", "CLI/CLI.hpp"), ("eval/report/report.cpp", "<", "mosbench/scan.hpp"),
                ("tests/unit/core/otsu_test.cpp", '"', "core/methods/hmm_mos/otsu.hpp")):
            self.assertIsNone(includes.complaint(name, quote, header), (name, header))

    def test_rooms_above_and_beside_are_refused(self):
        for name, header in (("core/voxel/raycast.cpp", "core/methods/hmm_mos/hmm.hpp"),
                             ("core/odometry/kiss.cpp", "core/methods/hmm_mos/hmm.hpp"),
                             ("datasets/text/text.cpp", "eval/answer/render.hpp"),
                             ("core/base/scan_method.cpp", "datasets/disk/files.hpp")):
            self.assertIn("must not include", includes.complaint(name, '"', header) or "", (name, header))

    def test_core_neither_reads_nor_prints(self):
        for header in ("fstream", "iostream", "filesystem", "cstdio", "fmt/format.h", "nlohmann/json.hpp", "pcl/io.h"):
            self.assertIn("core must not use", includes.complaint("core/methods/hmm_mos/hmm.cpp", "<", header) or "", header)
        self.assertIsNone(includes.complaint("datasets/disk/files.cpp", "<", "filesystem"))

    def test_paths_are_whole_and_methods_come_by_their_public_face(self):
        for quote, header in (('"', "hmm.hpp"), ('"', "core/methods/hmm_mos/absent.hpp"), ("<", "mosbench/absent.hpp"),
                              ('"', "core/include/mosbench/scan.hpp")):
            self.assertIn("is neither a path", includes.complaint("core/methods/hmm_mos/hmm.cpp", quote, header) or "", header)


class Mutants(unittest.TestCase):
    def test_every_patch_applies_and_says_what_is_wrong(self):
        patches = sorted(mutants.PATCHES.glob("*.patch"))
        self.assertGreaterEqual(len(patches), 60)
        self.assertEqual([f"{patch.name}: {fault}" for patch in patches for fault in mutants.faults_of(patch)], [])
        for patch in patches:
            self.assertTrue(mutants.programs_of(patch), patch.name)

    def test_a_patch_without_a_reason_or_for_other_lines_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            whole = sorted(mutants.PATCHES.glob("*.patch"))[0].read_text()
            silent, stale = pathlib.Path(folder) / "silent.patch", pathlib.Path(folder) / "stale.patch"
            silent.write_text(whole[whole.index("diff --git"):])
            stale.write_text("Its lines are gone.\n" + whole[whole.index("diff --git"):].replace("\n-", "\n-x", 2))
            self.assertEqual(mutants.faults_of(silent), ["no reason above the diff"])
            self.assertIn("does not apply", "".join(mutants.faults_of(stale)))

    def test_the_test_that_failed_or_ended_the_program_is_found(self):
        outputs = {
            "[ RUN      ] A.b\n[  FAILED  ] A.b (0 ms)\n[  FAILED  ] A.b\n": "A.b",
            "[ RUN      ] A.b\n[       OK ] A.b\n[ RUN      ] A.c\nterminate called\n": "A.c",
            "F\n=== short test summary info ===\nFAILED tests/python/data_test.py::test_it - assert 1\n": "test_it",
            "ERROR tests/python/data_test.py::test_it[a] - OSError\n": "test_it",
            "": None,
        }
        for output, test in outputs.items():
            self.assertEqual(mutants.failed_test(output), test, output)

    def test_bindings_of_python_are_tested_by_the_tests_of_python(self):
        patches = [patch for patch in mutants.PATCHES.glob("*.patch") if "eval/python/" in mutants.file_of(patch)]
        self.assertTrue(patches)
        for patch in patches:
            self.assertEqual(mutants.programs_of(patch), (mutants.PYTHON,), patch.name)


if __name__ == "__main__":
    unittest.main()
