"""bench_compare.py on ratios of known spread and on programs that fail: run by ctest."""

import math
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest
from random import Random

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts/bench"
sys.path.insert(0, str(SCRIPTS))
import bench_compare  # noqa: E402


def program(folder, name, body):
    path = pathlib.Path(folder) / name
    path.write_text(f"#!{sys.executable}\n{body}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def compare(*arguments):
    return subprocess.run([sys.executable, str(SCRIPTS / "bench_compare.py"), *arguments],
                          capture_output=True, text=True, check=False)


class BenchCompare(unittest.TestCase):
    def test_ranks_enclose_the_median_as_often_as_promised(self):
        # n = 31: P(fewer than 8 of 31 below the median) = 0.17 %, fewer than 9 = 0.53 %.
        self.assertEqual(bench_compare.interval_ranks(31, 0.99), (8 - 1, 31 - 8))
        self.assertEqual(bench_compare.interval_ranks(6, 0.95), (0, 5))

    def verdicts(self, slow_down, spread, trials):
        """How often `trials` comparisons of noisy ratios find more than 3 per cent."""
        random, found = Random(7), 0
        for _ in range(trials):
            ratios = [slow_down * math.exp(random.gauss(0, spread)) for _ in range(31)]
            ratios[3] *= 5  # a run that something else sat on
            found += bench_compare.is_slower(bench_compare.median_and_interval(ratios, 0.99)[1], 3)
        return found

    def test_a_slow_down_of_ten_per_cent_is_found(self):
        self.assertEqual(self.verdicts(1.10, 0.04, 20), 20)

    def test_equal_programs_are_left_in_peace(self):
        self.assertEqual(self.verdicts(1.0, 0.06, 200), 0)

    def test_pairs_alternate_and_the_new_one_is_the_numerator(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "log"
            append = f"open({str(log)!r}, 'a').write"
            old = program(folder, "old", f"{append}('o')")
            new = program(folder, "new", f"{append}('n'); sum(range(20_000_000))")
            answer = compare("--pairs", "8", "--threshold", "50", old, new, "--", "x")
            self.assertEqual(answer.returncode, 1, answer.stderr)  # costs many times as much
            self.assertIn("SLOWER", answer.stdout)
            self.assertEqual(log.read_text(), "on" + "onnonoon" * 2)
            self.assertGreater(float(answer.stdout.split()[5].rstrip(",")), 2.0)
            answer = compare("--pairs", "8", new, old, "--", "x")
            self.assertEqual(answer.returncode, 0, answer.stderr)
            self.assertIn("not slower", answer.stdout)

    def test_program_that_fails_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            good = program(folder, "good", "pass")
            bad = program(folder, "bad", "raise SystemExit('no such scan')")
            answer = compare(good, bad, "--", "x")
            self.assertEqual(answer.returncode, 3)
            self.assertIn("bad: exit code 1", answer.stderr)
            self.assertIn("no such scan", answer.stderr)

    def test_wrong_usage_exits_with_2(self):
        self.assertEqual(compare("absent", "absent").returncode, 2)
        self.assertEqual(compare("--pairs", "2", "a", "b").returncode, 2)
        self.assertEqual(compare("--pairs", "7", "a", "b").returncode, 2)  # too few for 99 %
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(compare(folder, folder).returncode, 2)
            broken = pathlib.Path(folder) / "broken"
            broken.write_text("#!/absent/interpreter\n")
            broken.chmod(0o755)
            self.assertEqual(compare(str(broken), str(broken), "--", "x").returncode, 3)


if __name__ == "__main__":
    unittest.main()
