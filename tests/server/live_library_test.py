# SPDX-License-Identifier: Apache-2.0
"""Runs devices of others against the real server: the examples of libkerf_agent, and drivers of
kerf-agent outside of it."""
import json
import os
import re
import subprocess
import sys

from kept_logs import keep, run_tests
from live_server import SCENE, LiveTest
from machine_stalls import succeeds

PRESS = os.environ["KERF_PRESS"]
PRESS_CPP = os.environ["KERF_PRESS_CPP"]
PRESS_PY = os.environ["KERF_PRESS_PY"]
LIBRARY = os.environ["KERF_AGENT_LIBRARY"]
AGENT = os.environ["KERF_AGENT"]
PLUGIN = os.environ["KERF_HAND_PLUGIN"]
SOCKET_HAND = os.environ["KERF_SOCKET_HAND"]
ROS2_NODE = os.path.join(os.path.dirname(PRESS_PY), "ros2_node.py")
# Pressing and cutting with the scene's 10 mm ball stay below the device's limit.
MOST_N = 6.0


class Examples(LiveTest):
    def check(self, status, text, session):
        self.assertEqual(status, 0, text)
        pressed, cut = map(float, re.search(
            r"greatest force: pressing ([0-9.]+) N, cutting ([0-9.]+) N", text).groups())
        self.assertTrue(0.1 < pressed <= MOST_N and 0.1 < cut <= MOST_N, text)
        # A slot of 15 mm, into whose stock a soft hand presses the ball.
        self.assertGreater(self.server.info(session)["removed_volume_mm3"], 5, text)

    def press(self, commands):
        """Runs one program for each session at the same time; returns the status and text of each."""
        running = {}
        for session, words in commands.items():
            self.server.create(session, SCENE)
            running[session] = subprocess.Popen(words, stdout=subprocess.PIPE,
                                                stderr=subprocess.STDOUT, text=True)
        texts = {session: keep(session, process.communicate(timeout=60)[0])
                 for session, process in running.items()}
        return {session: (running[session].returncode, text) for session, text in texts.items()}

    def test_devices_in_three_languages_press_and_cut(self):
        """A loaded machine may trip an agent, which is then run again."""
        url = f"http://127.0.0.1:{self.port}"
        words = {"in_c": lambda session: [PRESS, url, session],
                 "in_cpp": lambda session: [PRESS_CPP, url, session],
                 "in_python": lambda session: [sys.executable, PRESS_PY, url, session, LIBRARY]}
        left, texts = set(words), {}

        def attempt(number):
            done = self.press({f"{name}_{number}": words[name](f"{name}_{number}")
                               for name in sorted(left)})
            for name in sorted(left):
                session = f"{name}_{number}"
                status, texts[name] = done[session]
                if status != 0 and "gave up after" in texts[name]:
                    continue
                self.check(status, texts[name], session)
                left.remove(name)
            return not left

        self.assertTrue(succeeds(self, attempt), "\n".join(texts.values()))

    def test_agent_runs_a_plugin_and_a_device_of_another_process(self):
        path = os.path.join(self.folder.name, "hand")
        hand = subprocess.Popen([sys.executable, SOCKET_HAND, path], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)
        devices = {"example hand": f"plugin:{PLUGIN}:0.5", "socket_hand": f"socket:{path}"}
        running = {}
        for device, argument in devices.items():
            self.server.create(device.replace(" ", "_"), SCENE)
            running[device] = subprocess.Popen(
                [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session",
                 device.replace(" ", "_"), "--device", argument, "--status-json", "-"],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for device, process in running.items():
            out, log = process.communicate(timeout=60)
            keep("agent", log)
            self.assertEqual(process.returncode, 0, log)
            status = json.loads(out)
            self.assertEqual(status["device"], device)
            self.assertEqual(status["link"]["unanswered"], 0)
            self.assertGreater(status["link"]["samples_sent"], 500)
            session = self.server.info(device.replace(" ", "_"))
            self.assertGreater(session["removed_volume_mm3"], 5)
        text = hand.communicate(timeout=60)[0]
        self.assertEqual(hand.returncode, 0, text)
        self.assertRegex(text, "greatest force: [0-9.]+ N")

    def run_ros_node(self, session):
        """Returns what the node felt most, N and Nm, in how many messages, and its output."""
        self.server.create(session, SCENE)
        given = {"server": f"http://127.0.0.1:{self.port}", "session": session, "library": LIBRARY}
        stand_in = os.path.join(os.path.dirname(os.path.abspath(__file__)), "ros_stand_in")
        node = subprocess.run(
            [sys.executable, ROS2_NODE], capture_output=True, text=True, timeout=100,
            env={**os.environ, "PYTHONPATH": stand_in, "ROS_PARAMETERS": json.dumps(given)})
        self.assertEqual(node.returncode, 0, node.stdout + node.stderr)
        force, torque, count = map(float, re.search(
            r"greatest ([0-9.]+) N, ([0-9.]+) Nm in ([0-9]+) messages", node.stdout).groups())
        return force, torque, count, node.stdout

    def test_the_ros_2_node_carves_with_a_stand_in_for_rclpy(self):
        runs = []

        def attempt(number):
            runs.append((f"ros_{number}", *self.run_ros_node(f"ros_{number}")))
            return runs[-1][1] > 0.1

        self.assertTrue(succeeds(self, attempt, 2), runs[-1][-1])
        session, force, torque, count, output = runs[-1]
        self.assertLessEqual(force, 3.001, output)
        self.assertEqual(torque, 0, "it has no motors for torque")
        self.assertGreater(count, 1000)
        self.assertGreater(self.server.info(session)["removed_volume_mm3"], 5, output)


if __name__ == "__main__":
    run_tests()
