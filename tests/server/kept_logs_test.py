# SPDX-License-Identifier: Apache-2.0
"""What a failed case leaves is there, and nothing else: of a made-up test program, in a process."""
import os
import subprocess
import sys
import tempfile
import unittest

PROGRAM = '''
import subprocess
import unittest
from kept_logs import Output, keep, run_tests

def start(word):
    return Output(subprocess.Popen(["sh", "-c", f"echo {word}; echo more"], text=True,
                                   stdout=subprocess.PIPE).stdout, "server")

class Case(unittest.TestCase):
    def test_good(self):
        self.assertEqual(start("fine").next_with("mor", 60), "more\\n")

    def test_bad(self):
        out = start("trouble")
        self.assertEqual(out.whole(), "trouble\\nmore\\n")
        keep("agent", "the agent's")
        self.assertEqual(IS_GOOD, True)

run_tests()
'''


class KeptLogs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(folder.cleanup)
        self.kept = os.path.join(folder.name, "failed")

    def run_program(self, is_good):
        here = os.path.dirname(os.path.abspath(__file__))
        environment = {**os.environ, "KERF_FAILED": self.kept, "PYTHONPATH": here}
        return subprocess.run([sys.executable, "-B", "-c", f"IS_GOOD = {is_good}\n{PROGRAM}"],
                              env=environment, capture_output=True, text=True, timeout=60)

    def text_of(self, name):
        with open(os.path.join(self.kept, "Case.test_bad", name), encoding="utf-8") as file:
            return file.read()

    def test_a_failed_case_leaves_what_its_programs_wrote_until_it_passes(self):
        done = self.run_program(is_good=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertTrue(done.stderr.endswith(f"logs of what failed: {self.kept}\n"), done.stderr)
        self.assertEqual(os.listdir(self.kept), ["Case.test_bad"])
        self.assertEqual(self.text_of("01-server.log"), "trouble\nmore\n")
        self.assertEqual(self.text_of("02-agent.log"), "the agent's")
        done = self.run_program(is_good=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(os.path.exists(self.kept))


if __name__ == "__main__":
    unittest.main()
