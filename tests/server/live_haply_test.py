# SPDX-License-Identifier: Apache-2.0
"""Tests the adapter of the Haply Inverse3 against an emulator of its service: alone, and with the
real kerf-agent and server."""
import json
import math
import os
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from haply_service import Service
from kept_logs import run_tests  # noqa: E402
from live_server import LiveTest
from machine_stalls import succeeds
from waiting import eventually  # noqa: E402

AGENT = os.environ["KERF_AGENT"]
HAPLY = os.environ["KERF_HAPLY"]
# Events that the load of the test machine causes.
BUSY_MACHINE = ("lost_ticks", "lost_ticks_in_a_row", "device_lost")
sys.path.insert(0, os.path.dirname(HAPLY))

from kerf_haply import axis_of, listen, position_of  # noqa: E402


class Bridge:
    """The adapter as a process, and a connection in place of kerf-agent's."""

    def __init__(self, folder, service, *more):
        self.path = os.path.join(folder, "haply")
        self.process = subprocess.Popen([sys.executable, HAPLY, self.path, "--service", service.url,
                                         *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True)

    def join(self):
        self.socket = socket.socket(socket.AF_UNIX)
        eventually(self.connects, "the adapter does not listen", 20)
        self.socket.settimeout(20)
        self.lines = self.socket.makefile("r")
        self.capabilities = self.lines.readline().split()
        self.socket.sendall(b"session 3 50 -20 -20 -20 20 20 0\n")
        return self

    def connects(self):
        try:
            self.socket.connect(self.path)
            return True
        except OSError:
            return False

    def leave(self):
        self.lines.close()
        self.socket.close()

    def pose(self):
        """The next pose: state, tip, axis, buttons, accepted number."""
        line = self.lines.readline()
        if not line:
            raise ConnectionError
        words = line.split()
        assert words[0] == "pose", line
        numbers = list(map(float, words[2:]))
        return words[1], numbers[:3], numbers[3:6], int(numbers[6]), int(numbers[7])

    def pose_when(self, holds):
        """The first of the next poses for which the condition holds."""
        until_s = time.monotonic() + 20
        while not holds(pose := self.pose()):
            assert time.monotonic() < until_s, pose
        return pose

    def stop(self):
        self.process.terminate()
        return self.process.communicate(timeout=20)


class Adapter(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-haply-")
        self.service = Service()
        self.bridge = Bridge(self.folder.name, self.service)

    def tearDown(self):
        self.bridge.stop()
        self.service.stop()
        self.folder.cleanup()
        self.assertEqual(self.service.faults, [])

    def wait(self, condition):
        eventually(condition, "what the adapter was to do", 20)

    def test_states_force_only_and_places_the_pivot_at_the_cursor(self):
        agent = self.bridge.join()
        self.assertEqual(agent.capabilities[:2], ["kerf-device", "1"])
        stated = dict(word.split("=") for word in agent.capabilities[2:])
        self.assertEqual(stated["actuated_dof"], "3")
        self.assertEqual(stated["sensed_dof"], "5")
        self.assertNotIn("max_torque_nmm", stated)
        # The grip's +Y, along which it points, is turned about x by 180 degrees: down in y.
        state, tip, axis, _, _ = agent.pose()
        self.assertEqual(state, "ready")
        self.assertAlmostEqual(axis[1], 1, places=6)
        # The pivot lies where it would with the tip 10 mm above the stock.
        self.service.aim = lambda t: (0.01, 0.02, -0.03)
        moved = agent.pose_when(lambda pose: abs(pose[1][2] - tip[2] + 30) < 0.1)[1]
        self.assertAlmostEqual(moved[0] - tip[0], 10, delta=0.2)
        self.assertAlmostEqual(moved[1] - tip[1], 20, delta=0.2)
        self.assertEqual([round(v, 3) for v in tip], [0, 0, 10])
        self.service.orientation = (math.sqrt(0.5), math.sqrt(0.5), 0, 0)  # +Y points to +z
        agent.pose_when(lambda pose: pose[2][2] < -0.999)
        agent.leave()
        self.assertTrue(all(name.startswith("org.kerf") for name in self.service.profiles))

    def test_forwards_forces_while_they_are_renewed(self):
        agent = self.bridge.join()
        agent.pose()
        for number in range(1, 300):
            agent.socket.sendall(f"wrench {number} 0.5 -1 2 9 9 9\n".encode())
            if self.service.newest_force() == (0.5, -1, 2):
                break
            agent.pose()
        self.assertEqual(self.service.newest_force(), (0.5, -1, 2))
        agent.pose_when(lambda pose: pose[4] == number)  # acknowledged
        self.wait(lambda: self.service.newest_force() == (0, 0, 0))  # not renewed
        agent.socket.sendall(b"wrench 301 0 0 3 0 0 0\n")
        agent.leave()
        self.wait(lambda: self.service.newest_force() == (0, 0, 0))

    def restart(self, *more, **service):
        """Another service, and an adapter to it."""
        self.bridge.stop()
        self.service.stop()
        self.service = Service(**service)
        self.bridge = Bridge(self.folder.name, self.service, *more)

    def push(self, agent, newtons=2, least=1):
        """Sends a force until the service carries out half of it; returns how many poses it took."""
        for number in range(1, 3000):
            agent.socket.sendall(f"wrench {number} 0 0 {newtons} 0 0 0\n".encode())
            if self.service.newest_force()[2] > least:
                return number
            agent.pose()
        self.fail("the service carries out no force")

    def test_speaks_both_dialects_from_the_first_message_on(self):
        for word, session_id in (("vector", True), ("values", False)):
            self.restart(word=word, session_id=session_id)
            agent = self.bridge.join()
            agent.pose()
            self.push(agent)
            self.assertEqual(self.service.ignored, 0, word)
            self.assertEqual(self.bridge.stop()[1], "", word)  # first: it says that an agent left
            agent.leave()

    def test_a_service_that_ignores_the_force_is_sent_the_other_dialect(self):
        for word, session_id in (("vector", False), ("values", True)):
            self.restart(word=word, session_id=session_id)
            agent = self.bridge.join()
            agent.pose()
            self.push(agent)
            first = next(f for _, f in self.service.forces if any(f))
            self.assertLess(first[2], 0.2, "it rises from zero")
            agent.leave()
            self.assertIn(f"the force is sent as '{word}'", self.bridge.stop()[1])

    def test_a_service_that_takes_no_force_is_reported_once(self):
        self.restart(word="other")
        agent = self.bridge.join()
        agent.pose()
        for number in range(1, 1200):
            agent.socket.sendall(f"wrench {number} 0 0 2 0 0 0\n".encode())
            agent.pose()
        agent.leave()
        lines = self.bridge.stop()[1].splitlines()
        self.assertEqual(sum("takes no force" in line for line in lines), 1, lines)
        self.assertEqual(len([line for line in lines if "force" in line]), 2, lines)

    def test_an_error_of_the_service_is_reported_once(self):
        agent = self.bridge.join()
        self.service.error = "the device is in use"
        for _ in range(50):
            agent.pose()
        agent.leave()
        self.assertEqual(self.bridge.stop()[1].count("reports: the device is in use"), 1)

    def test_buttons_b_and_c_rearm_and_undo(self):
        agent = self.bridge.join()
        self.service.more_buttons = {"b": True, "c": False}
        agent.pose_when(lambda pose: pose[3] == 1024)
        self.service.more_buttons = {"b": False, "c": True}
        agent.pose_when(lambda pose: pose[3] == 256)
        agent.leave()

    def test_without_a_grip_it_cuts_if_asked_to(self):
        for more, states in (((), False), (("--cut", "always"), True)):
            self.restart(*more)
            self.service.grips = False
            agent = self.bridge.join()
            self.assertEqual("always_cut=1" in agent.capabilities, states)
            agent.leave()
            self.assertEqual("--cut always" in self.bridge.stop()[0], not states)

    def test_an_uncalibrated_device_and_a_missing_grip(self):
        self.service.calibrated = False
        agent = self.bridge.join()
        self.assertEqual(agent.pose()[0], "homing")
        agent.socket.sendall(b"wrench 1 0 0 3 0 0 0\n")
        agent.pose_when(lambda pose: pose[4] == 1)
        self.assertTrue(all(force == (0, 0, 0) for _, force in self.service.forces))
        self.service.calibrated = self.service.button = True
        agent.pose_when(lambda pose: pose[0] == "ready" and pose[3] == 1)
        self.service.grips = False
        agent.pose_when(lambda pose: pose[3] == 0)  # a lost grip does not cut
        agent.leave()

    def test_a_lost_service_ends_the_connection_and_is_found_again(self):
        agent = self.bridge.join()
        agent.pose()
        port = self.service.port
        self.service.stop()
        with self.assertRaises(OSError):
            while True:
                agent.pose()
        agent.leave()
        self.service = Service(port=port)
        again = self.bridge.join()
        self.assertEqual(again.pose()[0], "ready")
        again.leave()

    def test_a_service_that_is_not_there_is_named_once(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            port = unused.getsockname()[1]
        bridge = subprocess.Popen([sys.executable, HAPLY, self.bridge.path + "2", "--service",
                                   f"ws://127.0.0.1:{port}"], stderr=subprocess.PIPE, text=True)
        first = bridge.stderr.readline()
        time.sleep(1.2)
        bridge.terminate()
        rest = bridge.communicate()[1]
        self.assertIn(f"ws://127.0.0.1:{port} cannot be reached", first)
        self.assertIn("start Haply Hub", first)
        self.assertEqual(rest, "")

    def test_a_message_that_is_no_state_ends_the_connection_only(self):
        for odd in ("[1]", "null", "[" * 5000 + "]" * 5000, '{"inverse3": ["049D"]}'):
            agent = self.bridge.join()
            agent.pose()
            self.service.odd.append(odd)
            with self.assertRaises(OSError, msg=odd[:20]):
                while True:
                    agent.pose()
            agent.leave()
        self.assertIsNone(self.bridge.process.poll())

    def test_a_position_out_of_range_is_an_error(self):
        self.assertEqual(position_of({"x": 0.1, "y": -0.2, "z": 0}), [0.1, -0.2, 0])
        for far in (1e308, -101, math.inf, math.nan):
            with self.assertRaises(ValueError):
                position_of({"x": 0, "y": far, "z": 0})

    def test_numbers_of_options_are_in_range(self):
        for option, value, range_ in (("--max-force", "nan", "0 to 100"),
                                      ("--max-stiffness", "-1", "0 to 100"),
                                      ("--latency", "inf", "0 to 20"), ("--latency", "x", "0 to 20")):
            done = subprocess.run([sys.executable, HAPLY, "unused", option, value],
                                  capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"argument {option}: must be a number from {range_}", done.stderr)

    def test_replaces_a_socket_but_no_file(self):
        path = os.path.join(self.folder.name, "kept")
        with open(path, "w") as file:
            file.write("text")
        done = subprocess.run([sys.executable, HAPLY, path], capture_output=True, text=True,
                              timeout=20)
        self.assertEqual(done.returncode, 2)
        self.assertIn("exists and is not a socket", done.stderr)
        with open(path) as file:
            self.assertEqual(file.read(), "text")
        left = os.path.join(self.folder.name, "left")
        listen(left).close()  # a socket stays where it was
        listen(left).close()

    def test_axis_of_the_grip(self):
        self.assertEqual(axis_of({"w": 1, "x": 0, "y": 0, "z": 0}, 1), [0, 1, 0])
        half = math.sqrt(0.5)
        for q, sign, axis in (((half, half, 0, 0), 1, (0, 0, 1)), ((half, 0, 0, half), -1, (1, 0, 0)),
                              ((2 * half, -2 * half, 0, 0), -1, (0, 0, 1))):
            got = axis_of(dict(zip("wxyz", q)), sign)
            for a, b in zip(got, axis):
                self.assertAlmostEqual(a, b)
        with self.assertRaises(ValueError):
            axis_of({"w": 0, "x": 0, "y": 0, "z": 0}, 1)


class Session(LiveTest):
    def carve(self, session):
        """Presses and cuts in a session of its own; returns the agent's summary and its log."""
        start_s = time.monotonic() + 1.8  # the agent has joined and armed

        def aim(now_s):
            t = now_s - start_s
            self.service.button = t > 1
            down = min(0.014, max(0.0, 0.02 * t))
            return (0.01 * min(1.5, max(0.0, t - 1)), 0.0, -down)

        half = math.sqrt(0.5)
        self.server.create(session)
        self.service = Service(aim, orientation=(half, -half, 0, 0))  # the grip points down
        bridge = Bridge(self.folder.name, self.service)
        done = subprocess.run(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", session, "--device",
             f"socket:{bridge.path}", "--duration", "4.2", "--status-json", "-"],
            capture_output=True, text=True, timeout=60)
        bridge.stop()
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
