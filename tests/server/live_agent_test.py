# SPDX-License-Identifier: Apache-2.0
"""Tests the real kerf-agent with the real server: slow lines, several devices, kerf-agent doctor. What
is felt through slow lines: live_felt_test.py."""
import json
import math
import os
import signal
import socket
import subprocess
import threading

from delaying_relay import Line, Relay
from kept_logs import keep, path_of, run_tests
from live_server import SCENE, LiveTest, until

AGENT = os.environ["KERF_AGENT"]
FAR = Line(rtt_s=0.1, jitter=0.2, loss=0.02)
FARTHER = Line(rtt_s=0.25, jitter=0.2, stall_s=0.2)
BALL, MILL = 1, 2


def table(poses):
    """Returns the text of a pose file from tuples (seconds, tip, cutting[, axis])."""
    lines = ["t_s,x,y,z,i,j,k,cutting"]
    for time_s, tip, cutting, *axis in poses:
        numbers = (time_s, *tip, *(axis[0] if axis else (0, 0, 1)))
        lines.append(",".join(f"{n:.9g}" for n in numbers) + f",{int(cutting)}")
    return "\n".join(lines) + "\n"


def rows(mm_per_s=60.0):
    """Straight cuts with a flat mill, all turns in the air. The result does not depend on the positions
    of the samples along them, so it is bitwise equal for every line."""
    time_s, poses = 0.5, [(0, (-40, -12, -2), False)]
    for i, y in enumerate((-12, -6, 1, 7)):
        ends = (-40, 40) if i % 2 == 0 else (40, -40)
        poses.append((time_s, (ends[0], y, -2 - i), False))
        time_s += 80 / mm_per_s
        poses.append((time_s, (ends[1], y, -2 - i), True))
        time_s += 0.2
    return table(poses)


def spiral(seconds=2.0):
    """Rests above the block until the device is armed, then cuts along a circle with a tilted tool."""
    poses = [(0, (4, 0, 3), False), (0.6, (4, 0, 3), False)]
    for i in range(201):
        part = i / 200
        angle, radius = 5 * part, 4 + 6 * part
        around = (math.cos(angle), math.sin(angle))
        tip = (radius * around[0], radius * around[1], 3 - 6 * min(1, 3 * part))
        poses.append((0.6 + seconds * part, tip, True, (0.2 * around[0], 0.2 * around[1], 1)))
    return table(poses)


class AgentTest(LiveTest):
    def path(self, text, name="path.csv"):
        name = os.path.join(self.folder.name, name)
        with open(name, "w") as file:
            file.write(text)
        return name

    def run_agent(self, *words, session="block", port=None):
        """Waits until the agent exits; returns its summary."""
        where = os.path.join(self.folder.name, f"{session}.json")
        url = f"http://127.0.0.1:{port or self.port}"
        done = subprocess.run(
            [AGENT, "--server", url, "--session", session, "--status-json", where, *words],
            capture_output=True, text=True, timeout=120)
        keep("agent", done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(where) as file:
            return json.load(file)

    def check_arrived(self, status, info):
        """Checks that every sample was answered, on one connection."""
        link = status["link"]
        self.assertEqual((link["unanswered"], link["rejected_results"], link["bad_frames"]),
                         (0, 0, 0))
        self.assertEqual((link["connections"], link["forgotten"], link["errors"]), (1, 0, {}))
        self.assertGreater(link["results"], 0)
        removed = info["removed_volume_mm3"]
        self.assertGreater(removed, 10)
        self.assertAlmostEqual(status["removed_mm3"], removed, delta=removed * 1e-4)

    def check_line(self, relay, status):
        """Checks the delay of the line; no upper limit, which a loaded machine might exceed."""
        line = relay.up.line
        self.assertGreaterEqual(status["link"]["ping_us"]["p50"],
                                line.rtt_s * (1 - line.jitter) * 1e6)
        for direction in (relay.up, relay.down):
            self.assertGreater(direction.pieces, 100)
            self.assertEqual(direction.lost > 0, line.loss > 0)
            self.assertEqual(direction.stalled > 0, line.stall_s > 0)


class ThroughASlowLine(AgentTest):
    def test_the_carved_block_is_bitwise_equal(self):
        words = ("--tool", str(MILL), "--device", "replay:" + self.path(rows()))
        self.check_arrived(self.run_agent(*words), self.server.info())
        expected = self.server.hash()
        for session, line in (("far", FAR), ("farther", FARTHER)):
            self.server.create(session, SCENE)
            self.assertNotEqual(self.server.hash(session), expected)
            with Relay(self.port, line) as relay:
                status = self.run_agent(*words, session=session, port=relay.port)
            self.check_line(relay, status)
            self.check_arrived(status, self.server.info(session))
            self.assertEqual(self.server.hash(session), expected, line)


class SeveralDevices(AgentTest):
    def start(self, *words):
        with open(path_of("agent"), "w") as log:
            process = subprocess.Popen(
                [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", "block",
                 "--status-json", os.path.join(self.folder.name, "hand.json"), *words],
                stdout=subprocess.PIPE, stderr=log, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        return process

    def summaries(self, process):
        """Returns the summaries of both devices after the agent has exited."""
        self.assertEqual((process.wait(60), process.communicate()[0].count("carved")), (0, 2))
        found = []
        for name in ("hand.json", "hand.json.2"):
            with open(os.path.join(self.folder.name, name)) as file:
                found.append(json.load(file))
        return found

    def wait_for_both(self):
        until(self, lambda: {person["name"] for person in self.server.info()["participants"]},
              {"Ada", "Ada 2"})

    def test_two_devices_join_as_two_participants(self):
        process = self.start("--name", "Ada", "--device", "replay:" + self.path(rows()),
                             "--device", "sim:" + self.path(spiral(), "other.csv"))
        self.wait_for_both()
        one, two = self.summaries(process)
        self.assertEqual((one["device"], two["device"]), ("replay", "simulated hand"))
        self.assertNotEqual(one["participant"], two["participant"])
        for summary in (one, two):
            self.assertGreater(summary["removed_mm3"], 10)
            self.assertEqual((summary["failure"], summary["link"]["unanswered"]), ("", 0))
        removed = self.server.info()["removed_volume_mm3"]
        self.assertAlmostEqual(one["removed_mm3"] + two["removed_mm3"], removed,
                               delta=removed * 1e-4)

    def test_one_signal_makes_both_leave(self):
        process = self.start("--name", "Ada", "--loop", "--device", "sim", "--device", "sim")
        self.wait_for_both()
        process.send_signal(signal.SIGINT)
        for summary in self.summaries(process):
            self.assertEqual((summary["failure"], summary["link"]["unanswered"]), ("", 0))


class Profile(AgentTest):
    def test_a_profile_is_used_for_its_own_device_only(self):
        profile = self.path("kerf-device-profile 1\ndevice simulated hand\n", "own.profile")
        words = ("--device", "sim", "--duration", "0.2")
        self.run_agent(*words, "--profile", profile)
        other = self.path("kerf-device-profile 1\ndevice pen\n", "other.profile")
        done = subprocess.run(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", "block", *words,
             "--profile", other], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("--profile: the profile was measured on the pen, and this is the simulated "
                      "hand; measure this device", done.stderr)


class Doctor(LiveTest):
    def ask(self, port):
        done = subprocess.run(
            [AGENT, "doctor", "--seconds", "0.1", "--server", f"http://127.0.0.1:{port}"],
            capture_output=True, text=True, timeout=60)
        lines = done.stdout.splitlines()
        # Devices and permissions depend on the machine; the exit code must match the output. A
        # warning (permissions, a slow machine) and the absence of a USB device are no failure.
        fine = not any(line.startswith("missing") for line in lines)
        self.assertEqual(done.returncode, 0 if fine else 1, done.stdout)
        return [line for line in lines if str(port) in line], lines[-1]

    def test_reachable_server_is_reported(self):
        self.assertRegex(self.ask(self.port)[0][0],
                         f"^ok +the server 127.0.0.1:{self.port} is healthy; round trip [0-9]+ us")

    def test_unreachable_server_is_reported(self):
        with socket.create_server(("127.0.0.1", 0)) as other:
            port = other.getsockname()[1]
            answering = threading.Thread(target=self.answer_once, args=(other,))
            answering.start()
            found, last = self.ask(port)
            answering.join()
        self.assertRegex(found[0], "^missing +no healthy kerf-server at .*404")
        self.assertIn("Some checks failed", last)

    def answer_once(self, listener):
        with listener.accept()[0] as asked:
            asked.recv(1000)
            asked.sendall(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n")


if __name__ == "__main__":
    run_tests()
