# SPDX-License-Identifier: Apache-2.0
"""The rule about sleeps detects each kind of them, in made-up sources, and accepts what is none."""
import pathlib
import tempfile
import unittest

from sleep_check import found_in, sleeps_in, violations

SLEEPING = {
    "a.cpp": ["std::this_thread::sleep_for(5ms);", "std::this_thread::sleep_until(next);",
              "::usleep(5000);", "clock_nanosleep(CLOCK_MONOTONIC, 0, &t, nullptr);", "sleep(1);"],
    "a.py": ["time.sleep(0.2)", "await asyncio.sleep(1)", "select.select([], [], [], 0.1)"],
    "a.mjs": ["await new Promise((resolve) => setTimeout(resolve, 20));",
              "await page.waitForTimeout(200);"],
    "a.ts": ["const kill = setTimeout(end, 100);"],
    "a.sh": ["sleep 1", "while true; do sleep 0.1; done"],
}
AWAKE = {
    "a.cpp": ["void sleep_until_ns(std::uint64_t time_ns);", "// sleep_for(1s) would be slow",
              "asleep(1);"],
    "a.py": ["eventually(lambda: done, 'the end')", "# time.sleep(1) is refused",
             "select.select([client], [], [], 0.002)"],
    "a.mjs": ["await until('the end', 60, isDone);", "clearTimeout(kill);"],
    "a.ts": ["await turn();"],
    "a.sh": ["# sleep 1", "echo sleepers"],
    "a.md": ["sleep 1"],
}
ROW = ("tests/a.py", 1, "poll", "eventually: a server has no event")


class SleepCheck(unittest.TestCase):
    def test_each_call_that_sleeps_is_found(self):
        for name, lines in SLEEPING.items():
            for line in lines:
                self.assertEqual(sleeps_in(name, f"first\n{line}\n"), [2], line)

    def test_nothing_else_is(self):
        for name, lines in AWAKE.items():
            for line in lines:
                self.assertEqual(sleeps_in(name, line), [], line)

    def test_one_more_than_listed_is_refused_at_its_line(self):
        self.assertEqual(violations({"tests/a.py": [3]}, [ROW]), [])
        for table in ([], [ROW]):
            wrong, = violations({"tests/a.py": [3, 8]}, table)
            self.assertTrue(wrong.startswith("tests/a.py:8: "), wrong)

    def test_one_that_is_gone_leaves_the_table(self):
        wrong, = violations({}, [ROW])
        self.assertIn("lower the count", wrong)

    def test_a_row_has_a_known_kind_and_a_reason_and_is_the_only_one(self):
        for row in ((*ROW[:2], "nap", "a reason"), (*ROW[:3], "")):
            self.assertEqual(len(violations({"tests/a.py": [3]}, [row])), 1)
        self.assertEqual(len(violations({"tests/a.py": [3]}, [ROW, ROW])), 1)

    def test_benches_and_packages_are_not_read(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder)
            for name in ("tests/bench/a.py", "tests/e2e/node_modules/a/a.py",
                         "tests/e2e/a_bench.mjs", "tests/b/a.py", "web/test/a.py"):
                (source / name).parent.mkdir(parents=True, exist_ok=True)
                (source / name).write_text("time.sleep(1) or setTimeout(1)\n")
            self.assertEqual(found_in(source), {"tests/b/a.py": [1], "web/test/a.py": [1]})


if __name__ == "__main__":
    unittest.main()
