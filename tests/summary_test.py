# SPDX-License-Identifier: Apache-2.0
"""What test.sh prints at its end, of made-up results."""
import contextlib
import io
import json
import pathlib
import tempfile
import unittest
from unittest import mock

import summary

CTEST = """<testsuite>
<testcase name="quick" status="run" time="0.5"/>
<testcase name="slow" status="run" time="70.25"/>
<testcase name="live_a" status="fail" time="3"><failure message=""/></testcase>
<testcase name="usb" status="notrun" time="0"><skipped message="SKIP_RETURN_CODE=77"/>
<system-out>skipped: no device</system-out></testcase>
{more}</testsuite>"""
VITEST = {"success": True, "numPassedTests": 1, "testResults": [
    {"name": "/a/tiles.test.ts", "status": "passed",
     "assertionResults": [{"status": "passed", "fullName": " tiles keep", "duration": 1500}]}]}


class Summary(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = pathlib.Path(folder.name) / "results"
        self.results.mkdir()

    def write(self, name, text):
        (self.results / name).write_text(text)

    def printed(self):
        """Lines and exit status."""
        out = io.StringIO()
        with mock.patch("sys.argv", ["summary.py", str(self.results)]), \
                contextlib.redirect_stdout(out), self.assertRaises(SystemExit) as end:
            summary.main()
        return out.getvalue().splitlines(), end.exception.code

    def test_the_slowest_of_each_group_come_first_and_the_sum_last(self):
        self.write("ctest-fast.xml", CTEST.format(more=""))
        self.write("vitest.json", json.dumps(VITEST))
        self.write("cpu.txt", "build 12.25\ntests 99.5\n")
        lines, status = self.printed()
        self.assertEqual(lines[0], "Slowest of fast: 4 tests, 73.8 s in all")
        self.assertEqual([line.split()[-1] for line in lines[1:5]],
                         ["slow", "live_a", "quick", "usb"])
        self.assertEqual(lines[5:7], ["Slowest of web: 1 tests, 1.5 s in all",
                                      "     1.50 s  tiles.test.ts: tiles keep"])
        self.assertEqual(lines[7:], ["CPU time of the programs that have ended: build 12 s, tests 100 s",
                                     "skipped  usb: no device", "FAILED   live_a",
                                     "3 passed, 1 failed"])
        self.assertEqual(status, 1)

    def test_ten_are_named(self):
        more = "".join(f'<testcase name="n{n}" status="run" time="{n}"/>' for n in range(20))
        self.write("ctest-fast.xml", CTEST.format(more=more))
        named = [line for line in self.printed()[0] if line.startswith("  ")]
        self.assertEqual(len(named), 10)

    def test_a_failed_test_is_named_with_the_folder_of_what_it_left(self):
        self.write("ctest-server.xml", CTEST.format(more=""))
        left = self.results.parent / "failed" / "live_a"
        left.mkdir(parents=True)
        self.assertIn(f"FAILED   live_a (logs: {left})", self.printed()[0])


if __name__ == "__main__":
    unittest.main()
