# SPDX-License-Identifier: Apache-2.0
"""A user of a Haply Inverse3: the adapter with an emulator of its service, the real kerf-agent and the
real server. What the adapter does alone: tests/agent/haply."""
import json
import math
import os
import subprocess
import sys
import time

from haply_service import Service
from kept_logs import run_tests
from live_server import LiveTest
from machine_stalls import succeeds

AGENT = os.environ["KERF_AGENT"]
HAPLY = os.environ["KERF_HAPLY"]
# Events caused by the load of the test machine.
BUSY_MACHINE = ("lost_ticks", "lost_ticks_in_a_row", "device_lost")


class Session(LiveTest):
    def carve(self, session):
        """Presses and cuts in a session of its own; returns the agent's summary and its log."""
        start_s = time.monotonic() + 1.8  # by then the agent has joined and armed

        def aim(now_s):
            t = now_s - start_s
            self.service.button = t > 1
            down = min(0.014, max(0.0, 0.02 * t))
            return (0.01 * min(1.5, max(0.0, t - 1)), 0.0, -down)

        half = math.sqrt(0.5)
        self.server.create(session)
        self.service = Service(aim, (half, -half, 0, 0))  # the grip points down
        path = os.path.join(self.folder.name, "haply")
        adapter = subprocess.Popen([sys.executable, HAPLY, path, "--service", self.service.url],
                                   stdout=subprocess.DEVNULL)
        done = subprocess.run(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", session, "--device",
             f"socket:{path}", "--duration", "4.2", "--status-json", "-"],
            capture_output=True, text=True, timeout=60)
        adapter.terminate()
        adapter.wait(20)
        self.service.stop()
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), done.stderr

    def test_a_user_of_the_inverse3_presses_cuts_and_feels(self):
        runs = []

        def attempt(number):
            session = f"haply{number}"
            runs.append((session, *self.carve(session)))
            return runs[-1][1]["safety"]["last_trip"] not in BUSY_MACHINE

        succeeds(self, attempt)
        session, status, log = runs[-1]
        self.assertEqual(status["safety"]["trips"], 0, log)
        self.assertEqual(self.service.faults, [])
        self.assertEqual(status["device"], "haply_inverse3")
        strongest = max(math.hypot(*force) for _, force in self.service.forces)
        self.assertGreater(self.server.info(session)["removed_volume_mm3"], 5, log)
        self.assertTrue(0.05 < strongest <= 3.001, (strongest, log))
        self.assertEqual(self.service.newest_force(), (0, 0, 0))


if __name__ == "__main__":
    run_tests()
