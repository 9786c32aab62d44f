# SPDX-License-Identifier: Apache-2.0
"""The adapter of the Haply Inverse3, in this process and on a clock of the test: against a model of the
service, and with a script in place of kerf-agent. With the service's WebSocket, the real agent and the
real server: tests/server/live_haply_test.py."""
import base64
import contextlib
import hashlib
import io
import json
import math
import os
import socket
import struct
import sys
import tempfile
import types
import unittest
from unittest import mock

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "server"))
sys.path.insert(0, os.path.join(ROOT, "haptic_agent", "haply"))

import kerf_haply  # noqa: E402
from haply_service import Inverse3Model  # noqa: E402

TICKS_MAX = 5000  # of one script; only ends a failed test


class NoPose(Exception):
    pass


class ScriptFailed(BaseException):
    """The adapter treats other exceptions as a loss of the service."""


class Channel:
    """Replaces the adapter's WebSocket: the model answers at once."""

    def __init__(self, model, clock):
        self.model, self.clock = model, clock
        self.waiting = [model.begin(clock.now_s)]

    def send(self, message):
        answer = self.model.answer(json.loads(json.dumps(message)), self.clock.now_s)
        self.waiting.append(answer)

    def receive(self):
        if self.model.is_gone:
            raise kerf_haply.Lost("it closed the connection")
        message = self.waiting.pop(0)
        return kerf_haply.message_of(message if isinstance(message, str) else json.dumps(message))

    def close(self):
        pass


class AgentEnd:
    """The other end of the adapter's connection to kerf-agent."""

    def __init__(self, connection):
        self.socket, self.unread = connection, b""
        connection.sendall(b"session 3 50 -20 -20 -20 20 20 0\n")
        connection.setblocking(False)

    def read(self):
        with contextlib.suppress(OSError):  # nothing has come, or the script has left
            while came := self.socket.recv(65536):
                self.unread += came

    def line(self):
        """Returns the words of the next line; an empty list without one."""
        self.read()
        line, _, self.unread = self.unread.partition(b"\n")
        return line.decode().split()

    def pose(self):
        """Returns the next pose: state, tip, axis, buttons, accepted number. NoPose without one."""
        words = self.line()
        if not words:
            raise NoPose
        assert words[0] == "pose", words
        numbers = list(map(float, words[2:]))
        return types.SimpleNamespace(state=words[1], tip=numbers[:3], axis=numbers[3:6],
                                     buttons=int(numbers[6]), accepted=int(numbers[7]))

    def wrench(self, number, x, y, z):
        self.socket.sendall(f"wrench {number} {x} {y} {z} 9 9 9\n".encode())

    def leave(self):
        self.socket.close()


class Adapter(unittest.TestCase):
    """Runs serve() while a script, a generator, acts as the agent: it advances with each tick."""

    def setUp(self):
        self.now_s = 100.0
        self.model = self.service()

    def service(self, **more):
        model = Inverse3Model(**more)
        model.is_gone = False
        return model

    # ---- the clock of the adapter, and its listener ----
    def monotonic(self):
        return self.now_s

    def advance(self, seconds):
        self.now_s += seconds
        self.ticks += 1
        if self.agent:
            self.agent.read()
        try:
            assert self.ticks < TICKS_MAX, "the script does not end"
            has_ended = next(self.script, self) is self
        except Exception as fault:
            raise ScriptFailed from fault
        if has_ended:
            raise KeyboardInterrupt

    def accept(self):
        theirs, ours = socket.socketpair()
        self.addCleanup(ours.close)
        self.agent = AgentEnd(ours)
        return theirs, None

    def run_adapter(self, script, *words, transport=None):
        """Runs it as `kerf_haply.py PATH words` until the script ends; returns its output."""
        self.script, self.ticks, self.agent = script, 0, None
        out, err = io.StringIO(), io.StringIO()
        clock = types.SimpleNamespace(monotonic=self.monotonic, sleep=self.advance)
        connect = transport or (lambda url: Channel(self.model, self))
        with mock.patch.object(kerf_haply, "time", clock), \
                mock.patch.object(kerf_haply, "Service", connect), \
                mock.patch.object(kerf_haply, "listen", return_value=self), \
                mock.patch.object(sys, "argv", ["kerf_haply.py", "unused", *words]), \
                contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            kerf_haply.main()
        self.assertEqual(self.model.faults, [])
        return out.getvalue(), err.getvalue()

    def pose_when(self, holds):
        """Returns the next pose that satisfies the condition; use with `yield from`."""
        while not holds(pose := self.agent.pose()):
            yield
        return pose

    def push(self, newtons=2, least=1):
        """Sends a force until the service carries out half of it."""
        for number in range(1, 3000):
            self.agent.wrench(number, 0, 0, newtons)
            if self.model.newest_force()[2] > least:
                return
            yield
        self.fail("the service carries out no force")

    # ---- the cases ----
    def test_states_force_only_and_places_the_pivot_at_the_cursor(self):
        def script():
            capabilities = self.agent.line()
            self.assertEqual(capabilities[:2], ["kerf-device", "1"])
            stated = dict(word.split("=") for word in capabilities[2:])
            self.assertEqual((stated["actuated_dof"], stated["sensed_dof"]), ("3", "5"))
            self.assertNotIn("max_torque_nmm", stated)
            # The grip's +Y, its direction, is turned about x by 180 degrees: down in y.
            first = self.agent.pose()
            self.assertEqual(first.state, "ready")
            self.assertAlmostEqual(first.axis[1], 1, places=6)
            # The position of the pivot with the tip 10 mm above the stock.
            self.assertEqual([round(v, 3) for v in first.tip], [0, 0, 10])
            self.model.aim = lambda t: (0.01, 0.02, -0.03)
            yield
            moved = yield from self.pose_when(lambda p: abs(p.tip[2] - first.tip[2] + 30) < 0.1)
            self.assertAlmostEqual(moved.tip[0] - first.tip[0], 10, delta=0.2)
            self.assertAlmostEqual(moved.tip[1] - first.tip[1], 20, delta=0.2)
            self.model.orientation = (math.sqrt(0.5), math.sqrt(0.5), 0, 0)  # +Y points to +z
            yield
            yield from self.pose_when(lambda p: p.axis[2] < -0.999)

        self.run_adapter(script())
        self.assertTrue(all(name.startswith("org.kerf") for name in self.model.profiles))

    def test_forwards_forces_while_they_are_renewed(self):
        def script():
            self.agent.line()
            self.agent.wrench(1, 0.5, -1, 2)
            yield
            self.assertEqual(self.model.newest_force(), (0.5, -1, 2))
            yield from self.pose_when(lambda p: p.accepted == 1)
            for _ in range(30):
                yield
            self.assertEqual(self.model.newest_force(), (0, 0, 0), "it is not renewed")
            self.agent.wrench(2, 0, 0, 3)
            yield
            self.assertEqual(self.model.newest_force(), (0, 0, 3))
            self.agent.leave()
            yield
            self.assertEqual(self.model.newest_force(), (0, 0, 3), "the connection has ended")
            yield
            self.assertEqual(self.model.newest_force(), (0, 0, 0), "it waits for the next agent")

        self.run_adapter(script())

    def test_speaks_both_dialects_from_the_first_message_on(self):
        def script():
            self.agent.line()
            yield from self.push()

        for word, session_id in (("vector", True), ("values", False)):
            self.model = self.service(word=word, session_id=session_id)
            self.assertEqual(self.run_adapter(script())[1], "", word)
            self.assertEqual(self.model.ignored, 0, word)

    def test_a_service_that_ignores_the_force_is_sent_the_other_dialect(self):
        def script():
            self.agent.line()
            yield from self.push()

        for word, session_id in (("vector", False), ("values", True)):
            self.model = self.service(word=word, session_id=session_id)
            self.assertIn(f"the force is sent as '{word}'", self.run_adapter(script())[1])
            first = next(f for _, f in self.model.forces if any(f))
            self.assertLess(first[2], 0.2, "it rises from zero")

    def test_a_service_that_takes_no_force_is_reported_once(self):
        def script():
            self.agent.line()
            for number in range(1, 1200):
                self.agent.wrench(number, 0, 0, 2)
                yield

        self.model = self.service(word="other")
        lines = self.run_adapter(script())[1].splitlines()
        self.assertEqual(sum("takes no force" in line for line in lines), 1, lines)
        self.assertEqual(len([line for line in lines if "force" in line]), 2, lines)

    def test_an_error_of_the_service_is_reported_once(self):
        def script():
            self.model.error = "the device is in use"
            for _ in range(50):
                yield

        self.assertEqual(self.run_adapter(script())[1].count("reports: the device is in use"), 1)

    def test_buttons_b_and_c_rearm_and_undo(self):
        def script():
            self.agent.line()
            for pressed, bit in (({"b": True, "c": False}, 1024), ({"b": False, "c": True}, 256)):
                self.model.more_buttons = pressed
                yield
                yield from self.pose_when(lambda p, wanted=bit: p.buttons == wanted)

        self.run_adapter(script())

    def test_without_a_grip_it_cuts_if_asked_to(self):
        stated = []

        def script():
            stated.append("always_cut=1" in self.agent.line())
            yield

        for more, states in (((), False), (("--cut", "always"), True)):
            self.model = self.service()
            self.model.grips = False
            out, _ = self.run_adapter(script(), *more)
            self.assertEqual(stated.pop(), states)
            self.assertEqual("--cut always" in out, not states)

    def test_an_uncalibrated_device_and_a_missing_grip(self):
        def script():
            self.agent.line()
            self.assertEqual(self.agent.pose().state, "homing")
            self.agent.wrench(1, 0, 0, 3)
            yield
            yield from self.pose_when(lambda p: p.accepted == 1)
            self.assertTrue(all(force == (0, 0, 0) for _, force in self.model.forces))
            self.model.calibrated = self.model.button = True
            yield
            yield from self.pose_when(lambda p: p.state == "ready" and p.buttons == 1)
            self.model.grips = False
            yield
            yield from self.pose_when(lambda p: p.buttons == 0)  # a lost grip does not cut

        self.model.calibrated = False
        self.run_adapter(script())

    def lost_connection(self):
        """Expects the end of the poses; use with `yield from`."""
        with contextlib.suppress(NoPose):
            while True:
                self.agent.pose()
                yield

    def test_a_lost_service_ends_the_connection_and_is_found_again(self):
        def script():
            first = self.agent
            first.line()
            self.model.is_gone = True
            yield from self.lost_connection()
            for _ in range(3):
                yield
            self.model.is_gone = False
            while self.agent is first:
                yield
            self.agent.line()
            self.assertEqual(self.agent.pose().state, "ready")

        self.assertEqual(self.run_adapter(script())[1], "lost: it closed the connection\n")

    def test_a_service_that_is_not_there_is_named_once(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            url = f"ws://127.0.0.1:{unused.getsockname()[1]}"
        _, err = self.run_adapter(iter(range(5)), "--service", url, transport=kerf_haply.Service)
        self.assertIn(f"{url} cannot be reached", err)
        self.assertIn("start Haply Hub", err)
        self.assertEqual(err.count("\n"), 1, err)

    def test_a_message_that_is_no_state_ends_the_connection_only(self):
        def script():
            for odd in ("[1]", "null", "[" * 5000 + "]" * 5000, '{"inverse3": ["049D"]}'):
                before = self.agent
                before.line()
                self.model.odd.append(odd)
                yield from self.lost_connection()
                while self.agent is before:
                    yield

        self.run_adapter(script())


class Transport(unittest.TestCase):
    """The adapter's WebSocket, against the bytes of a service."""

    def connect(self, *frames):
        """A service whose first messages are these frames."""
        ours, theirs = socket.socketpair()
        self.addCleanup(ours.close)
        ours.settimeout(30)  # only ends a failed test
        key = base64.b64encode(bytes(16)).decode()
        accept = base64.b64encode(hashlib.sha1((key + kerf_haply.GUID).encode()).digest()).decode()
        ours.sendall(b"HTTP/1.1 101 Switching Protocols\r\nSec-WebSocket-Accept: " +
                     accept.encode() + b"\r\n\r\n" + b"".join(frames))
        self.ours = ours
        with mock.patch.object(kerf_haply.os, "urandom", bytes), \
                mock.patch.object(kerf_haply.socket, "create_connection", return_value=theirs), \
                mock.patch.object(theirs.__class__, "setsockopt"):
            service = kerf_haply.Service("ws://localhost:10001/path")
        self.addCleanup(service.close)
        self.assertIn(b"GET /path HTTP/1.1\r\nHost: localhost:10001\r\n", ours.recv(4096))
        return service

    @staticmethod
    def frame(kind, data, last=True):
        return struct.pack(">BBH", (0x80 if last else 0) | kind, 126, len(data)) + data

    def test_messages_in_parts_are_joined_and_pings_answered(self):
        service = self.connect(self.frame(1, b'{"a":', last=False), self.frame(9, b"hi"),
                               self.frame(0, b" 1}"))
        self.assertEqual(service.receive(), {"a": 1})
        pong = self.ours.recv(100)
        self.assertEqual((pong[0], pong[1]), (0x8A, 0x80 | 2), "masked")
        self.assertEqual(bytes(a ^ b for a, b in zip(pong[6:], pong[2:6] * 2)), b"hi")

    def test_malformed_frames_and_the_end_are_losses(self):
        for bytes_sent, reason in ((b"\x81\xff" + bytes(8), "malformed"),
                                   (b"\x81\x7f" + struct.pack(">Q", 1 << 40), "malformed"),
                                   (self.frame(8, b""), "closed"),
                                   (self.frame(1, b"{"), "not JSON")):
            with self.assertRaisesRegex(kerf_haply.Lost, reason):
                self.connect(bytes_sent).receive()


class Parts(unittest.TestCase):
    def test_a_position_out_of_range_is_an_error(self):
        self.assertEqual(kerf_haply.position_of({"x": 0.1, "y": -0.2, "z": 0}), [0.1, -0.2, 0])
        for far in (1e308, -101, math.inf, math.nan):
            with self.assertRaises(ValueError):
                kerf_haply.position_of({"x": 0, "y": far, "z": 0})

    def complaint(self, *words):
        """Returns the error that main() prints for invalid arguments."""
        err = io.StringIO()
        with mock.patch.object(sys, "argv", ["kerf_haply.py", *words]), \
                contextlib.redirect_stderr(err), self.assertRaises(SystemExit) as ended:
            kerf_haply.main()
        self.assertEqual(ended.exception.code, 2)
        return err.getvalue()

    def test_numbers_of_options_are_in_range(self):
        for option, value, range_ in (("--max-force", "nan", "0 to 100"),
                                      ("--max-stiffness", "-1", "0 to 100"),
                                      ("--latency", "inf", "0 to 20"), ("--latency", "x", "0 to 20")):
            self.assertIn(f"argument {option}: must be a number from {range_}",
                          self.complaint("unused", option, value))

    def test_replaces_a_socket_but_no_file(self):
        with tempfile.TemporaryDirectory(prefix="kerf-haply-") as folder:
            path = os.path.join(folder, "kept")
            with open(path, "w", encoding="ascii") as file:
                file.write("text")
            self.assertIn("exists and is not a socket", self.complaint(path))
            with open(path, encoding="ascii") as file:
                self.assertEqual(file.read(), "text")
            left = os.path.join(folder, "left")
            kerf_haply.listen(left).close()  # a socket stays where it was
            kerf_haply.listen(left).close()

    def test_axis_of_the_grip(self):
        self.assertEqual(kerf_haply.axis_of({"w": 1, "x": 0, "y": 0, "z": 0}, 1), [0, 1, 0])
        half = math.sqrt(0.5)
        for q, sign, axis in (((half, half, 0, 0), 1, (0, 0, 1)), ((half, 0, 0, half), -1, (1, 0, 0)),
                              ((2 * half, -2 * half, 0, 0), -1, (0, 0, 1))):
            got = kerf_haply.axis_of(dict(zip("wxyz", q)), sign)
            for a, b in zip(got, axis):
                self.assertAlmostEqual(a, b)
        with self.assertRaises(ValueError):
            kerf_haply.axis_of({"w": 0, "x": 0, "y": 0, "z": 0}, 1)


if __name__ == "__main__":
    unittest.main()
