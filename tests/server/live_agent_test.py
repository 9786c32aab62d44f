# SPDX-License-Identifier: Apache-2.0
"""The real kerf-agent against the real server: through a slow line, as several hands, its doctor."""
import json
import math
import os
import signal
import socket
import subprocess
import threading
import time
import unittest

from delaying_relay import Line, Relay
from live_server import SCENE, LiveTest

AGENT = os.environ["KERF_AGENT"]
FAR = Line(rtt_s=0.1, jitter=0.2, loss=0.02)
FARTHER = Line(rtt_s=0.25, jitter=0.2, stall_s=0.2)
TANK_MJ = 30
# What the machine does to the agent, not the line: a test machine has other work to do as well.
BUSY_MACHINE = ("lost_ticks", "lost_ticks_in_a_row")
ATTEMPTS = 8
BALL, MILL = 1, 2


def table(poses):
    """A path as a file has it, of (seconds, tip, cutting) and, if the tool leans, its axis."""
    lines = ["t_s,x,y,z,i,j,k,cutting"]
    for time_s, tip, cutting, *axis in poses:
        numbers = (time_s, *tip, *(axis[0] if axis else (0, 0, 1)))
        lines.append(",".join(f"{n:.9g}" for n in numbers) + f",{int(cutting)}")
    return "\n".join(lines) + "\n"


def rows(mm_per_s=60.0):
    """Straight cuts with a flat mill, all turns in the air. What they leave does not depend on where
    along them the samples lie, so it is the same for every line, to the bit."""
    time_s, poses = 0.5, [(0, (-40, -12, -2), False)]
    for i, y in enumerate((-12, -6, 1, 7)):
        ends = (-40, 40) if i % 2 == 0 else (40, -40)
        poses.append((time_s, (ends[0], y, -2 - i), False))
        time_s += 80 / mm_per_s
        poses.append((time_s, (ends[1], y, -2 - i), True))
        time_s += 0.2
    return table(poses)


def spiral(seconds=2.0):
    """Rests above the block until the hand is armed, sinks into it and goes round, leaning."""
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
        """Until it leaves by itself; gives its summary."""
        where = os.path.join(self.folder.name, f"{session}.json")
        url = f"http://127.0.0.1:{port or self.port}"
        done = subprocess.run(
            [AGENT, "--server", url, "--session", session, "--status-json", where, *words],
            capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(where) as file:
            return json.load(file)

    def check_arrived(self, status, info):
        """Every sample was answered, on one connection, and the server lost nothing of it."""
        link = status["link"]
        self.assertEqual((link["unanswered"], link["rejected_results"], link["bad_frames"]),
                         (0, 0, 0))
        self.assertEqual((link["connections"], link["forgotten"], link["errors"]), (1, 0, {}))
        self.assertGreater(link["results"], 0)
        removed = info["removed_volume_mm3"]
        self.assertGreater(removed, 10)
        self.assertAlmostEqual(status["removed_mm3"], removed, delta=removed * 1e-4)

    def check_line(self, relay, status):
        """The line was as slow as it was meant to be; no upper limit, which a machine might miss."""
        line = relay.up.line
        self.assertGreaterEqual(status["link"]["ping_us"]["p50"],
                                line.rtt_s * (1 - line.jitter) * 1e6)
        for way in (relay.up, relay.down):
            self.assertGreater(way.pieces, 100)
            self.assertEqual(way.lost > 0, line.loss > 0)
            self.assertEqual(way.stalled > 0, line.stall_s > 0)


class ThroughASlowLine(AgentTest):
    def test_what_is_carved_is_the_same_to_the_bit(self):
        words = ("--tool", str(MILL), "--device", "replay:" + self.path(rows()))
        self.check_arrived(self.run_agent(*words), self.server.info())
        wanted = self.server.hash()
        for session, line in (("far", FAR), ("farther", FARTHER)):
            self.server.create(session, SCENE)
            self.assertNotEqual(self.server.hash(session), wanted)
            with Relay(self.port, line) as relay:
                status = self.run_agent(*words, session=session, port=relay.port)
            self.check_line(relay, status)
            self.check_arrived(status, self.server.info(session))
            self.assertEqual(self.server.hash(session), wanted, line)

    def feel(self, line):
        """A hand carves through the line; gives the summary of one that its machine did not trip."""
        words = ("--tool", str(BALL), "--device", "sim:" + self.path(spiral()))
        for attempt in range(ATTEMPTS):
            name = f"attempt-{attempt}"
            self.server.create(name, SCENE)
            with Relay(self.port, line) as relay:
                status = self.run_agent(*words, session=name, port=relay.port)
            self.check_line(relay, status)
            self.check_arrived(status, self.server.info(name))
            self.assertLess(status["force"]["most_returned_mj"], TANK_MJ)
            if status["safety"]["last_trip"] not in BUSY_MACHINE:
                return status
        self.skipTest("this machine is too busy for a loop of 1 kHz")

    def check_felt(self, status):
        self.assertEqual(status["safety"]["trips"], 0, status["safety"])
        self.assertGreater(status["force"]["server_max_n"], 0.2)
        self.assertGreater(status["force"]["max_n"], 0.2)
        self.assertLessEqual(status["force"]["max_n"], 8)
        self.assertEqual(status["force"]["not_finite"], 0)
        # What it felt came from its own copy of the block, and was what the server said later.
        copy = status["copy"]
        self.assertGreater(copy["answered"], 0.7 * copy["samples"])
        self.assertGreater(copy["felt_ticks"], 0)
        self.assertGreater(copy["compared"], 0)
        self.assertLess(copy["error"], 0.5)  # an answer of the server may be the mean of 16 samples
        self.assertEqual(copy["bad_patches"], 0)

    def test_a_hand_feels_the_cut_and_is_given_no_energy_at_100_ms_with_loss(self):
        self.check_felt(self.feel(FAR))

    def test_a_hand_feels_the_cut_and_is_given_no_energy_at_250_ms_with_stalls(self):
        self.check_felt(self.feel(FARTHER))


class SeveralHands(AgentTest):
    def start(self, *words):
        process = subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", "block",
             "--status-json", os.path.join(self.folder.name, "hand.json"), *words],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        return process

    def summaries(self, process):
        """Of both hands, when all has ended."""
        self.assertEqual((process.wait(60), process.communicate()[0].count("carved")), (0, 2))
        found = []
        for name in ("hand.json", "hand.json.2"):
            with open(os.path.join(self.folder.name, name)) as file:
                found.append(json.load(file))
        return found

    def wait_for_both(self):
        for _ in range(3000):
            names = {person["name"] for person in self.server.info()["participants"]}
            if names == {"Ada", "Ada 2"}:
                return
            time.sleep(0.01)
        self.fail(f"only {names} joined")

    def test_two_devices_of_one_command_line_join_as_two(self):
        process = self.start("--name", "Ada", "--device", "replay:" + self.path(rows()),
                             "--device", "sim:" + self.path(spiral(), "other.csv"))
        self.wait_for_both()
        one, two = self.summaries(process)
        self.assertEqual((one["device"], two["device"]), ("replay", "simulated hand"))
        self.assertNotEqual(one["participant"], two["participant"])
        for hand in (one, two):
            self.assertGreater(hand["removed_mm3"], 10)
            self.assertEqual((hand["failure"], hand["link"]["unanswered"]), ("", 0))
        removed = self.server.info()["removed_volume_mm3"]
        self.assertAlmostEqual(one["removed_mm3"] + two["removed_mm3"], removed,
                               delta=removed * 1e-4)

    def test_one_signal_makes_both_leave(self):
        process = self.start("--name", "Ada", "--loop", "--device", "sim", "--device", "sim")
        self.wait_for_both()
        process.send_signal(signal.SIGINT)
        for hand in self.summaries(process):
            self.assertEqual((hand["failure"], hand["link"]["unanswered"]), ("", 0))


class Doctor(LiveTest):
    def ask(self, port):
        done = subprocess.run(
            [AGENT, "doctor", "--seconds", "0.1", "--server", f"http://127.0.0.1:{port}"],
            capture_output=True, text=True, timeout=60)
        lines = done.stdout.splitlines()
        # Devices and rights are this machine's; the code must be that of what was printed.
        fine = not any(line.startswith(("warning", "missing")) for line in lines)
        self.assertEqual(done.returncode, 0 if fine else 1, done.stdout)
        return [line for line in lines if str(port) in line], lines[-1]

    def test_a_server_that_is_there_is_well(self):
        self.assertRegex(self.ask(self.port)[0][0],
                         f"^ok +the server 127.0.0.1:{self.port} is healthy; round trip [0-9]+ us")

    def test_what_is_no_server_is_said(self):
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
    unittest.main()
