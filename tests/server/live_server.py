# SPDX-License-Identifier: Apache-2.0
"""Starts and stops a real kerf-server for the tests."""
import faulthandler
import json
import os
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import Output  # noqa: E402
from waiting import eventually  # noqa: E402
from wire_client import PATIENCE, WAIT_S, Http, WebSocket  # noqa: E402

PROGRAM = os.environ["KERF_SERVER"]

# A test that takes this long prints its stack. ctest ends most tests after 300 s.
faulthandler.dump_traceback_later(280 * PATIENCE)

SCENE = {
    "name": "block",
    "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
    "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
              {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}],
    "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.5},
    "machine": {"kinematics": "tool-vector"},
}


class Server:
    def __init__(self, data, *more, port=0, tls=None, host="127.0.0.1", environment=None):
        self.data = data
        self.process = subprocess.Popen(
            [PROGRAM, "--listen", f"{host}:{port}", "--data", data, *more],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, **(environment or {})})
        self.log = Output(self.process.stderr, "server")
        line = self.process.stdout.readline()
        if not line.startswith(f"https://{host}:" if tls else f"http://{host}:"):
            raise RuntimeError(self.end()[1])
        self.port = int(line.rsplit(":", 1)[1])
        self.http = Http(self.port, tls, host)
        eventually(lambda: self.http.json("GET", "/readyz")[1]["status"] != "loading",
                   "the server has not loaded its sessions", 10 * WAIT_S, 0.005)

    def end(self):
        """Waits until the server has ended; returns its exit status and its log."""
        self.process.wait(timeout=2 * WAIT_S)
        self.process.stdout.close()
        return self.process.returncode, self.log.whole()

    def stop(self, how=signal.SIGTERM):
        """Stops the server; returns its exit status and its log."""
        self.process.send_signal(how)
        return self.end()

    def log_line(self, word):
        """The next line of the log with a word, once it is there."""
        return self.log.next_with(word, WAIT_S)

    def create(self, session="block", scene=None):
        status, body = self.http.json("POST", f"/v1/sessions?id={session}&here=1",
                                      json.dumps(scene or SCENE))
        assert status == 201, body
        return body

    def info(self, session="block"):
        return self.http.json("GET", f"/v1/sessions/{session}")[1]

    def hash(self, session="block"):
        return self.info(session)["state_hash"]


def until(test, ask, wanted, timeout=WAIT_S):
    """Waits until `ask()` is `wanted`; the test fails with what it was at last."""
    found = []

    def is_wanted():
        found[:] = [ask()]
        return found[0] == wanted

    try:
        eventually(is_wanted, "", timeout, 0.05)
    except AssertionError:
        test.assertEqual(found[0], wanted)


class FolderTest(unittest.TestCase):
    """A folder per test, and a server with one session `block` in it."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="kerf-test-")
        self.addCleanup(self.folder.cleanup)
        self.server = self.first_server()
        self.server.create()

    def first_server(self):
        return Server(self.folder.name)

    def tearDown(self):
        while WebSocket.opened:
            WebSocket.opened.pop().close()
        if self.server.process.poll() is None:
            status, log = self.server.stop()
            self.assertEqual(status, 0, log)


class LiveTest(FolderTest):
    """The same, with the server's port: the server stays the same one."""

    def setUp(self):
        super().setUp()
        self.port = self.server.port
