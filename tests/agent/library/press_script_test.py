# SPDX-License-Identifier: Apache-2.0
"""The message of the Python example if libkerf_agent cannot be loaded.

tests/server/live_library_test.py tests that the example carves."""
import os
import sys
import unittest
from unittest import mock

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "haptic_agent", "examples"))

import press  # noqa: E402


def is_not_there(name):
    raise OSError(name + ": not found")


class WithoutTheLibrary(unittest.TestCase):
    def test_says_how_it_is_built(self):
        for named in ((), ("/no/such/libkerf_agent.so.1",)):
            with mock.patch.object(sys, "argv", ["press.py", "http://localhost:1", "x", *named]), \
                    mock.patch.object(press.glob, "glob", return_value=[]), \
                    mock.patch.object(press.ctypes.util, "find_library", return_value=None), \
                    mock.patch.object(press.ctypes, "CDLL", is_not_there), \
                    self.assertRaises(SystemExit) as ended:
                press.main()
            text = ended.exception.code
            self.assertIn("./run.sh --build-only", text)
            self.assertIn((named[0] if named else "libkerf_agent.so.1") + ": not found", text)


if __name__ == "__main__":
    unittest.main()
