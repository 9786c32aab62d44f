# SPDX-License-Identifier: Apache-2.0
"""Tests a complete session with a USB device: the unmodified kerf-agent finds the reference device on a
mocked bus, homes it and carves on the real server; the device is unplugged in the middle of a cut and
plugged in again."""
import json
import os
import signal
import subprocess
import time

from kept_logs import path_of, run_tests
from live_server import LiveTest
from machine_stalls import succeeds
from waiting import eventually

AGENT = os.environ["KERF_AGENT"]
MOCK_PEN = os.environ["KERF_MOCK_PEN"]
WRAPPER = os.environ["KERF_UMOCKDEV_WRAPPER"]
# Limits of force and torque: low enough to be reached by the force of the cut (6 N), and for the
# motors to stay within their thermal limits (means over 10 s of 3 N and 100 N·mm).
MAX_N, MAX_NMM = 4.0, 80.0
# Maximum change of a wrench caused by rounding the six motors' torques to 0.1 N·mm.
ROUNDING_N, ROUNDING_NMM = 0.01, 0.2
# Trips that a loaded test machine can cause: delayed reports look like a jump of the pose.
BUSY_MACHINE = {"lost_ticks", "lost_ticks_in_a_row", "pose_jump", "tip_too_fast"}
# Longer than the agent's own delays; the tests assert none of these times.
RELEASE_S, ARMING_S = 0.4, 0.8
# Rows (y, z) to cut, 6 mm wide and 2 mm deep: one next to the other, then in the next layer.
ROWS = [(y, z) for z in range(-2, -17, -2) for y in range(-15, 16, 6)]


class Pen:
    """The mock device and the simulated user that moves it (tests/usb/mock_pen.cpp)."""

    def __init__(self):
        self.process = subprocess.Popen([WRAPPER, MOCK_PEN], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True, bufsize=1)
        self.bus = self.process.stdout.readline().strip()

    def __call__(self, *words):
        self.process.stdin.write(" ".join(str(word) for word in words) + "\n")
        answer = self.process.stdout.readline().strip()
        assert answer, f"no answer to {words}"
        return answer

    def felt(self):
        """Returns the largest force (N) and torque (N·mm) since the previous call."""
        return tuple(float(number) for number in self("felt").split())

    def end(self):
        self.process.stdin.close()
        self.process.wait(30)
        self.process.stdout.close()


class Session(LiveTest):
    def setUp(self):
        super().setUp()
        self.pen = Pen()
        self.addCleanup(self.pen.end)
        self.rows = iter(ROWS)
        self.log_path = path_of("agent")
        with open(self.log_path, "w") as log:
            self.agent = subprocess.Popen(
                [WRAPPER, AGENT, "--session", "block", "--device", "usb", "--tool", "2",
                 "--force-max", str(MAX_N), "--torque-max", str(MAX_NMM),
                 "--trip-log", self.file("trips.csv"), "--status-json", self.file("status.json"),
                 "--server", f"http://127.0.0.1:{self.port}"],
                env=dict(os.environ, UMOCKDEV_DIR=self.pen.bus), stdout=log, stderr=log)
        self.addCleanup(self.agent.wait)
        self.addCleanup(self.agent.kill)

    def file(self, name):
        return os.path.join(self.folder.name, name)

    def log(self):
        with open(self.log_path) as file:
            return file.read()

    def wait_for(self, condition, what):
        """Waits for a condition; the limit of 20 s is reached only if the test fails."""
        def holds():
            if not condition():
                self.assertIsNone(self.agent.poll(), self.log())
                return False
            return True

        eventually(holds, lambda: f"{what}\n{self.log()}", 20)

    def removed(self):
        return self.server.info()["removed_volume_mm3"]

    def trips(self):
        try:
            with open(self.file("trips.csv")) as file:
                return [line.split()[-1] for line in file if line.startswith("# trip:")]
        except FileNotFoundError:
            return []

    def plug(self, address):
        """Plugs the device in and waits until the agent has homed it."""
        before = self.log().count("is ready")
        self.pen("plug", address)
        self.wait_for(lambda: self.log().count("is ready") > before, "the device is not ready")
        self.assertTrue(self.pen("state").startswith("homed"))

    def unplug(self):
        before = self.log().count("unplugged")
        self.pen("unplug")
        self.wait_for(lambda: self.log().count("unplugged") > before,
                      "the agent did not notice the unplugging")

    def release_and_grip(self, arming_s=ARMING_S):
        """Moves above the next row, releases the grip and grips again."""
        self.row = next(self.rows)
        self.pen("press")
        self.pen("go", -24, self.row[0], 5, 100)
        time.sleep(RELEASE_S)
        self.pen("press", "grip")
        time.sleep(arming_s)

    def cut(self, *buttons, to=24):
        """Cuts along the current row."""
        self.pen("press", *buttons)
        self.pen("go", -24, *self.row, 60)
        self.pen("press", "cut", *buttons)
        self.pen("go", to, *self.row, 40)

    def retract(self):
        """Returns to the start of the row above the block."""
        self.pen("press", "grip")
        self.pen("go", 24, self.row[0], 5, 100)
        self.pen("go", -24, self.row[0], 5, 100)

    def feel_a_cut(self, least_n=0.5, least_nmm=1, to=24):
        """Cuts rows until one displays more than that force (N) and torque (N·mm): a loaded machine
        may trip the agent."""
        def attempt(number):
            self.release_and_grip(ARMING_S * (1 + number))
            self.pen.felt()
            self.cut("grip", to=to)
            force_n, torque_nmm = self.pen.felt()
            self.assertLessEqual(force_n, MAX_N + ROUNDING_N)
            self.assertLessEqual(torque_nmm, MAX_NMM + ROUNDING_NMM)
            felt = force_n > least_n and torque_nmm > least_nmm
            if not felt:
                self.retract()
            return felt

        if not succeeds(self, attempt):
            self.fail(f"no force was displayed\n{self.log()}")

    def test_device_is_homed_carves_and_recovers_from_unplugging(self):
        self.pen("plug", 5)
        self.wait_for(lambda: "is ready" in self.log(), "the device is not ready")
        self.assertIn("is homing", self.log())

        # A row of 40 x 6 x 2 mm. The grip is not held, so no force is displayed.
        self.row = next(self.rows)
        self.pen("go", -24, self.row[0], 5, 100)
        self.cut()
        self.wait_for(lambda: abs(self.removed() - 480) < 5, "the row was not carved")
        self.assertEqual(self.pen.felt(), (0, 0))
        self.retract()

        # The wrench of a full cut reaches the torque limit, at which force and torque are scaled by
        # one factor.
        self.feel_a_cut(least_nmm=MAX_NMM - ROUNDING_NMM)
        self.retract()
        for address in range(6, 9):
            self.feel_a_cut(to=0)
            self.unplug()
            if "device_lost" in self.trips():
                break
            self.plug(address)  # a loaded machine has tripped the agent earlier
        self.assertIn("device_lost", self.trips())

        # After reconnecting it carves again, but displays no force until the grip has been
        # released.
        before = self.removed()
        self.plug(9)
        self.retract()
        time.sleep(ARMING_S)
        self.row = next(self.rows)
        self.cut("grip")
        self.wait_for(lambda: self.removed() > before + 100, "the agent does not carve after reconnecting")
        self.assertEqual(self.pen.felt(), (0, 0))
        self.retract()
        # A request by the user, whose hand still holds the grip, has the same effect.
        before = self.log().count("the force is on")
        self.agent.send_signal(signal.SIGUSR1)
        self.wait_for(lambda: self.log().count("the force is on") > before, "SIGUSR1 has no effect")
        self.feel_a_cut()
        self.retract()
        self.check_exit()

    def check_exit(self):
        self.agent.send_signal(signal.SIGINT)
        self.assertEqual(self.agent.wait(60), 0, self.log())
        with open(self.file("status.json")) as file:
            status = json.load(file)
        self.assertEqual(status["device"], "5-DOF reference device")
        self.assertEqual((status["failure"], status["link"]["unanswered"]), ("", 0))
        self.assertEqual(status["link"]["connections"], 1)
        self.assertLessEqual(set(self.trips()), {"device_lost"} | BUSY_MACHINE)
        self.assertEqual(status["safety"]["trips"], len(self.trips()))
        removed = self.removed()
        self.assertAlmostEqual(status["removed_mm3"], removed, delta=removed * 1e-4)
        self.assertEqual(self.pen("state"), "homed 0")  # no command was rejected


if __name__ == "__main__":
    run_tests()
