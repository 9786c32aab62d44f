# SPDX-License-Identifier: Apache-2.0
"""A user of the real kerf-agent whose device has neither deadman nor button: learns why there is
no force, goes on after trips, and cuts."""
import collections
import json
import os
import signal
import socket
import subprocess
import threading
import time

from kept_logs import Output, run_tests
from live_server import SCENE, LiveTest
from waiting import eventually

AGENT = os.environ["KERF_AGENT"]
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
PRESS_PY = os.path.join(ROOT, "haptic_agent", "examples", "press.py")
WAIT_S = 60  # only ends a failed test
PERIOD_S = 0.002  # of the poses, about
# Longer than the agent takes to arm and to say so; a user who sees nothing acts again.
ACT_S = 2


class Device(threading.Thread):
    """Serves poses at about 500 Hz over a socket; the test moves the tip."""

    def __init__(self, path, keys):
        super().__init__(daemon=True)
        self.listener = socket.create_server(path, family=socket.AF_UNIX)
        self.keys, self.tip, self.more, self.ended = keys, [0.0, 0.0, 10.0], [], False
        self.most_up_n = 0.0  # of the wrenches since the test has set it to zero
        self.poses = 0  # that were served
        self.path = collections.deque()  # axis, mm: a step for each of the next poses
        self.start()

    def run(self):
        """Serves the agent, again after a loss: on a busy machine this thread may be late."""
        while not self.ended:
            try:
                with self.listener.accept()[0] as agent:
                    self.serve(agent)
            except OSError:
                continue

    def serve(self, agent):
        agent.sendall(f"kerf-device 1 name=bare sensed_dof=3 actuated_dof=3 max_force_n=10 "
                      f"moving_mass_kg=0.2 moving_inertia_kg_m2=1e-4{self.keys}\n".encode())
        agent.setblocking(False)
        unread = b""
        while not self.ended:
            try:
                while came := agent.recv(65536):
                    unread += came
                return
            except BlockingIOError:
                pass
            *lines, unread = unread.split(b"\n")
            for words in map(bytes.split, lines):
                if words[0] == b"wrench":
                    self.most_up_n = max(self.most_up_n, float(words[4]))
            if self.path:
                axis, by_mm = self.path.popleft()
                self.tip[axis] += by_mm
            x, y, z = self.tip
            lines = [self.more.pop(0)] if self.more else []
            lines.append(f"pose ready {x:.3f} {y:.3f} {z:.3f} 0 0 1 0 0")
            agent.sendall(("\n".join(lines) + "\n").encode())
            self.poses += 1
            time.sleep(PERIOD_S)

    def rest(self, seconds):
        """Waits until so many seconds of poses were served."""
        end = self.poses + seconds / PERIOD_S
        eventually(lambda: self.poses >= end, "the agent takes no poses")

    def jump(self):
        """By more than the agent takes for a motion: trips it."""
        self.tip[0] += 30
        self.rest(0.1)
        self.tip[0] -= 30

    def move(self, axis, by_mm, seconds):
        steps = int(seconds / PERIOD_S)
        self.path.extend([(axis, by_mm / steps)] * steps)
        eventually(lambda: not self.path, "the agent takes no poses")


class Rearm(LiveTest):
    def begin(self, session, keys="", *more):
        self.server.create(session, SCENE)
        path = os.path.join(self.folder.name, session)
        self.device = Device(path, keys)
        self.agent = subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", session, "--device",
             f"socket:{path}", "--status-json", "-", *more],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.log = Output(self.agent.stderr, "agent")

    def end(self):
        """Ends the agent; returns its summary."""
        self.agent.send_signal(signal.SIGINT)
        out = self.agent.stdout.read()
        self.agent.wait(WAIT_S)
        self.log.whole()
        self.agent.stdout.close()
        self.device.ended = True
        self.device.listener.close()
        return json.loads(out)

    def wait(self, condition, repeat=lambda: None, every_s=0.0):
        """Waits for a condition; until it holds, does `repeat` again when `every_s` has passed."""
        again_s = 0.0

        def holds():
            nonlocal again_s
            if condition():
                return True
            if time.monotonic() >= again_s:
                repeat()
                again_s = time.monotonic() + every_s
            return False

        eventually(holds, self.log.so_far, WAIT_S)

    def said(self, text):
        return sum(text in line for line in self.log.so_far().splitlines())

    def is_off(self):
        """Whether the newest word about the force is that it was switched off."""
        words = [line for line in self.log.so_far().splitlines()
                 if "force switched off" in line or "force is on" in line]
        return bool(words) and "force switched off" in words[-1]

    def trip(self):
        """A jump of the tip trips while the force is on; a machine that is busy may have done so
        before. The agent arms within ACT_S."""
        self.wait(self.is_off, self.device.jump, ACT_S)

    def rearm(self):
        self.device.more.append("rearm")

    def goes_on(self, act):
        """The agent says that the force is on after the user has acted. A busy machine may trip it
        at once again: then the user acts again."""
        before = self.said("the force is on")
        self.wait(lambda: self.said("the force is on") > before, act, ACT_S)

    def test_each_request_ends_a_trip_of_a_device_without_deadman_and_button(self):
        self.begin("requests")
        self.wait(lambda: self.said("carving 'requests'"))

        def signalled():
            self.agent.send_signal(signal.SIGUSR1)

        def gesture():
            self.device.rest(1.2)  # holds the tip still
            self.device.move(2, 12, 0.4)
            self.device.move(2, -12, 0.4)

        for act in (self.rearm, signalled, gesture):
            self.trip()
            self.goes_on(act)
        self.assertIn("To go on, hold the tip still for a second, then move it 1 cm away and back",
                      self.log.so_far())
        status = self.end()
        self.assertGreaterEqual(status["safety"]["trips"], 3)
        self.assertGreater(status["safety"]["no_force"]["ticks"]["tripped"], 100)

    def stroke(self):
        """Lowers the tip 1 mm into the block and lifts it, with the force on."""
        if self.is_off():
            self.goes_on(self.rearm)
        self.device.move(2, -11, 1.5)
        self.device.move(2, 11, 1)

    def test_without_a_button_it_cuts_while_the_force_is_on(self):
        for session, keys, *more in (("stated", " always_cut=1"), ("asked", "", "--always-cut")):
            self.begin(session, keys, *more)
            self.wait(lambda: self.said(f"carving '{session}'"))
            self.wait(lambda: self.server.info(session)["removed_volume_mm3"] > 5, self.stroke)
            self.end()

    def test_without_a_button_and_the_option_it_is_pushed_by_the_block_and_does_not_cut(self):
        self.begin("touches")
        self.wait(lambda: self.said("carving 'touches'"))
        self.trip()
        self.goes_on(self.rearm)  # from here on the log tells whether the force is on
        self.device.most_up_n = 0.0
        self.wait(lambda: self.device.most_up_n > 0.1, self.stroke)
        self.end()
        self.assertEqual(self.server.info("touches")["removed_volume_mm3"], 0)

    def test_says_why_there_is_no_force_once(self):
        self.begin("unheld", " deadman=1")
        self.wait(lambda: self.said("no force: the device is not held; hold its grip"))
        self.device.rest(1.5)
        self.assertEqual(self.said("no force"), 1, self.log.so_far())
        no_force = self.end()["safety"]["no_force"]
        self.assertEqual(no_force["reason"], "not_held")
        self.assertIn("not held", no_force["text"])

    def test_a_missing_session_is_named_in_a_sentence(self):
        done = subprocess.run([AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session",
                               "nowhere", "--device", "sim", "--patience", "1"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nowhere", done.stderr)
        self.assertNotIn("{", done.stderr)

    def test_the_python_example_says_how_the_library_is_built(self):
        alone = os.path.join(self.folder.name, "a", "b")
        os.makedirs(alone)
        with open(PRESS_PY) as source, open(os.path.join(alone, "press.py"), "w") as copy:
            copy.write(source.read())
        for named in ((), ("/no/such/libkerf_agent.so.1",)):
            done = subprocess.run(["python3", os.path.join(alone, "press.py"), "http://localhost:1",
                                   "x", *named], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 1)
            self.assertIn("./run.sh --build-only", done.stderr)
            self.assertIn(named[0] if named else "libkerf_agent.so.1", done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    run_tests()
