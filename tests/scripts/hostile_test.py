"""The hostile drivers damage what they should, repeat what a seed says, and see what is wrong: run by ctest."""

import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
from random import Random
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/hostile"))
import folders  # noqa: E402
import formats  # noqa: E402
import mutations  # noqa: E402
import oracle  # noqa: E402
import program  # noqa: E402
import writers  # noqa: E402

TEXT = b'{"voxel_size_m": 0.25, "names": ["a", "b"], "scans": 12}\n' * 3
SCAN = struct.pack("<8f", *range(8))


def ended(code=0, out="", err="", words=("score", "data"), hung=False):
    return program.Ended(list(words), code, hung, out, err)


class Mutations(unittest.TestCase):
    def test_a_seed_damages_the_same_bytes(self):
        for seed in range(200):
            first, second = (mutations.damage(Random(seed), TEXT, SCAN) for _ in range(2))
            self.assertEqual(first, second)

    def test_every_kind_of_damage_changes_something_and_takes_any_bytes(self):
        for kind in set(mutations.OF_BYTES):
            changed = 0
            for seed in range(60):
                for data in (TEXT, SCAN, b"", b"\xff\xfe", b"[" * 100_000):
                    damaged = kind(Random(seed), data, b"other")
                    self.assertIsInstance(damaged, bytes, kind)
                    changed += damaged != data
            self.assertGreater(changed, 60, kind)

    def test_special_files_take_the_place_of_a_file(self):
        seen = set()
        for seed in range(120):
            with tempfile.TemporaryDirectory() as top:
                folders.write(top, {"a/b.txt": b"text", "a/c.txt": b"text"})
                mutations.change_file(Random(seed), top, "a/b.txt")
                found = folders.contents(top)
                seen.add(found.get("a/b.txt", "gone"))
        self.assertLessEqual({"special", "folder", "link", "gone", b""}, seen)


class Hangs(unittest.TestCase):
    def ends(self, *words):
        with mock.patch.multiple(program, IDLE_S=1, LIMIT_CPU_S=0.2), subprocess.Popen(words) as process:
            return program.ends_in_time(process)

    def test_a_process_that_sleeps_or_uses_the_cpu_without_end_hangs(self):
        self.assertFalse(self.ends("sleep", "60"))
        self.assertFalse(self.ends("sh", "-c", "while :; do :; done"))

    def test_one_that_ends_does_not_hang(self):
        self.assertTrue(self.ends("sh", "-c", "exit 3"))


class Oracle(unittest.TestCase):
    def column_of(self, end):
        fault = program.fault_of(end)
        return fault[0] if fault else None

    def test_ends_that_are_documented_are_accepted(self):
        for end in (ended(), ended(2, err="mosbench: --x"), ended(3, err="mosbench: f: g"), ended(1, words=["doctor"])):
            self.assertIsNone(program.fault_of(end), end)

    def test_other_ends_are_faults(self):
        self.assertEqual(self.column_of(ended(-11)), "crashes")
        self.assertEqual(self.column_of(ended(70, err="internal fault")), "crashes")
        self.assertEqual(self.column_of(ended(1)), "crashes")
        self.assertEqual(self.column_of(ended(3)), "crashes")
        self.assertEqual(self.column_of(ended(0, err="x.cpp:3: runtime error: overflow")), "crashes")
        self.assertEqual(self.column_of(ended(0, hung=True)), "hangs")

    def faults(self, out, words):
        with tempfile.TemporaryDirectory() as case:
            return [column for column, _ in oracle.faults_of(ended(out=out, words=words), case, ())]

    def test_numbers_that_cannot_be_are_seen(self):
        json = ["stats", "run", "--json"]
        for text in ('{"iou": -0.1}', '{"a": [{"iou": 1.5}]}', '{"tp": -1}', '{"tp": 1.5}', '{"x": NaN}', "{", ""):
            self.assertEqual(self.faults(text, json), ["numbers"], text)
        for text in ('{"iou": null, "tp": 3}', '{"a": [{"iou": 1, "difference": -0.2}]}'):
            self.assertEqual(self.faults(text, json), [], text)
        self.assertEqual(self.faults("08      12  -0.500  0.1\n", ["run", "data"]), ["numbers"])
        self.assertEqual(self.faults("IoU  nan\n", ["stats", "run"]), ["numbers"])
        self.assertEqual(self.faults("08      12  0.500  0.1\nnano info\n", ["run", "data"]), [])
        self.assertEqual(self.faults("ms per scan nan\nms/scan nan\nscan inf\n", ["profile", "data"]), ["numbers"])
        self.assertEqual(self.faults("sequence 08: scan nan is only in the first run\n", ["bless", "run"]), [])

    def test_a_name_that_the_input_gives_may_say_inf(self):
        with tempfile.TemporaryDirectory() as case:
            folders.write(case, {"published.csv": b"I,range -inf m,Dynablox,84\nI,inf,LMNet,nan,MOE-Dataset -inf + README\n"})

            def faults(out):
                return oracle.faults_of(ended(out=out, words=["table", "I"]), case, ())
            self.assertEqual(faults("| Dynablox | range -inf m | 84 |\n"), [])
            self.assertEqual(faults("| LMNet | MOE-Dataset -inf + README |\n"), [])
            self.assertTrue(faults("| Dynablox | range inf m | 84 |\n"))
            self.assertTrue(faults("| Dynablox | range -inf m | -inf |\n"))
            self.assertTrue(faults("| LMNet | inf | nan |\n"))

    def test_a_name_that_the_command_line_gives_may_say_nan(self):
        for words in (["bless", "run", "nan"], ["bless", "run", "new/nan"], ["bless", "run", "--even-if=nan"]):
            self.assertEqual(self.faults("accepted run as nan\n", words), [], words)
        self.assertEqual(self.faults("method  IoU\n-inf    12.0\n", ["stats", "run", "--method", "-inf"]), [])
        # Not where a number stands, nor what nobody gave.
        self.assertEqual(self.faults("accepted run as nan\n", ["bless", "run", "nano"]), ["numbers"])
        for out in ("IoU  nan\n", "IoU nan\n", "| nan | 0.5 |\n", "IoU 0.5 -> nan\n", "ms: nan\n", "from 0.1 to nan\n"):
            self.assertEqual(self.faults(out, ["bless", "run", "inf", "nan"]), ["numbers"], out)

    def test_leftovers_are_seen_unless_they_were_there(self):
        with tempfile.TemporaryDirectory() as case:
            folders.write(case, {"out/08.partial/x": b""})
            self.assertEqual([column for column, _ in oracle.faults_of(ended(), case, ())], ["damaged"])
            self.assertEqual(oracle.faults_of(ended(), case, folders.leftovers(case)), [])


class Writers(unittest.TestCase):
    writer = writers.Writer("bless", [], {"baseline/1": b"old", "baseline/2": b"old"},
                            {"baseline/1": b"new", "baseline/2": b"new"}, 0.1)

    def test_old_and_new_files_are_whole(self):
        for found in (self.writer.before, self.writer.after, {**self.writer.before, "baseline/2.partial": b"ne"}):
            self.assertIsNone(writers.half_written(self.writer, found), found)

    def test_half_files_lost_files_and_mixtures_are_damage(self):
        for found in ({"baseline/1": b"ne", "baseline/2": b"old"}, {"baseline/2": b"new"},
                      {"baseline/1": b"new", "baseline/2": b"old"}):
            self.assertIsNotNone(writers.half_written(self.writer, found), found)


class Formats(unittest.TestCase):
    def test_literal_lzf_and_points_have_the_sizes_of_their_headers(self):
        points = formats.points_of(struct.pack("<400f", *range(400)))
        self.assertEqual(len(points), 100)
        body = formats.pcd(points, "binary_compressed").partition(b"DATA binary_compressed\n")[2]
        packed, unpacked = struct.unpack_from("<II", body)
        self.assertEqual((len(body) - 8, unpacked), (packed, 1600))
        self.assertEqual(len(formats.ply(points, "binary_big_endian").partition(b"end_header\n")[2]), 1600)


if __name__ == "__main__":
    unittest.main()
