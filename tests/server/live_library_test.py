# SPDX-License-Identifier: Apache-2.0
"""Runs the examples of libkerf_agent, each a device of its own, against the real server."""
import os
import re
import subprocess
import sys
import unittest

from live_server import SCENE, LiveTest

PRESS = os.environ["KERF_PRESS"]
PRESS_PY = os.environ["KERF_PRESS_PY"]
LIBRARY = os.environ["KERF_AGENT_LIBRARY"]
# Of the scene: pressing and cutting with the 10 mm ball stay below what the device may output.
MOST_N = 6.0


class Examples(LiveTest):
    def check(self, process, session):
        text = process.communicate(timeout=60)[0]
        self.assertEqual(process.returncode, 0, text)
        pressed, cut = map(float, re.search(
            r"greatest force: pressing ([0-9.]+) N, cutting ([0-9.]+) N", text).groups())
        self.assertTrue(0.1 < pressed <= MOST_N and 0.1 < cut <= MOST_N, text)
        # A slot of 15 mm, in which the ball is pressed into the stock by a soft hand.
        self.assertGreater(self.server.info(session)["removed_volume_mm3"], 5, text)

    def test_c_and_python_devices_press_and_cut(self):
        url = f"http://127.0.0.1:{self.port}"
        commands = {"in_c": [PRESS, url, "in_c"],
                    "in_python": [sys.executable, PRESS_PY, url, "in_python", LIBRARY]}
        running = {}
        for session, words in commands.items():
            self.server.create(session, SCENE)
            running[session] = subprocess.Popen(words, stdout=subprocess.PIPE,
                                                stderr=subprocess.STDOUT, text=True)
        for session, process in running.items():
            with self.subTest(session):
                self.check(process, session)

    def test_unknown_session_is_reported(self):
        done = subprocess.run([PRESS, f"http://127.0.0.1:{self.port}", "nowhere"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nowhere", done.stderr)


if __name__ == "__main__":
    unittest.main()
