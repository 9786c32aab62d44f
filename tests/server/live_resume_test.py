# SPDX-License-Identifier: Apache-2.0
"""A killed server loses nothing that an agent has felt: the agent sends it again."""
import json
import math
import os
import signal
import struct
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import keep, run_tests  # noqa: E402
from live_agent_test import AGENT, rows  # noqa: E402
from live_server import LiveTest, Server, until  # noqa: E402
from wire_client import CUTTING, MOTION, PING, PONG, RESULT, WebSocket, header, sample  # noqa: E402


def spiral_tip(i):
    angle, radius = 0.02 * i, 4 + 0.01 * i
    return radius * math.cos(angle), radius * math.sin(angle), -2 - 0.002 * i


class DurableAgent:
    """Keeps its samples until the server has stated that they are durable."""

    def __init__(self, port, session):
        self.session, self.token, self.epoch = session, None, 0
        self.sent = []      # poses by number, from 1
        self.durable = 0
        self.connect(port)

    def connect(self, port):
        self.socket = WebSocket(port, f"/v1/sessions/{self.session}/agent", "kerf.agent.v1")
        hello = {"type": "hello", "name": "Ada", "tool": 1, "durable": True}
        if self.token:
            hello["resume"] = self.token
        self.socket.send_json(hello)
        self.welcome = self.socket.receive_json("welcome")
        self.epoch = self.welcome["epoch"]
        self.token = self.welcome["resume"]["token"]
        self.send(max(1, self.welcome["resume"]["agent_sequence"], self.durable))

    def send(self, first):
        """Sends the samples from number `first` on, and reads their answers."""
        numbers = range(first, len(self.sent) + 1)
        for start in range(0, len(numbers), 16):
            samples = [sample(n, 1000 * n, self.sent[n - 1], buttons=CUTTING)
                       for n in numbers[start:start + 16]]
            payload = struct.pack("<II", len(samples), 0) + b"".join(samples)
            self.socket.send_binary(header(MOTION, len(payload), epoch=self.epoch) + payload)
            self.wait(RESULT)

    def wait(self, kind):
        while True:
            form, frame = self.socket.receive()
            if form != "binary":
                continue
            flags, header_bytes = frame[5], struct.unpack("<H", frame[6:8])[0]
            if flags & 1 and header_bytes >= 40:
                self.durable = max(self.durable, struct.unpack("<Q", frame[32:40])[0])
            if frame[4] == kind:
                return frame[header_bytes:]

    def ping(self):
        self.socket.send_binary(header(PING, 8, epoch=self.epoch) + struct.pack("<Q", 1))
        self.wait(PONG)

    def move(self, count):
        first = len(self.sent) + 1
        self.sent += [spiral_tip(len(self.sent) + i) for i in range(count)]
        self.send(first)


class Resume(LiveTest):
    def kill(self):
        self.server.stop(signal.SIGKILL)
        self.server = Server(self.folder.name, port=self.port)

    def run_agent(self, session):
        path = os.path.join(self.folder.name, "rows.csv")
        with open(path, "w") as file:
            file.write(rows(240.0))
        self.status = os.path.join(self.folder.name, session + ".json")
        return subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{self.port}", "--session", session, "--name", "Ada",
             "--device", "replay:" + path, "--tool", "2", "--status-json", self.status],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def committed(self):
        """The motions that a kill does not lose, nor the participants before them."""
        info = self.server.info()
        return info["motions"] - info["journal_lag"]

    def test_the_real_agent_continues_as_the_same_participant(self):
        self.server.create("whole")
        for session, kills in (("whole", 0), ("block", 2)):
            agent = self.run_agent(session)
            for _ in range(kills):
                before = self.committed()  # the agent may not have come back yet
                until(self, lambda b=before: self.committed() > b + 100, True)
                self.kill()
            log = keep("agent", agent.communicate(timeout=60)[1])
            self.assertEqual(agent.returncode, 0, log)
            with open(self.status) as file:
                link = json.load(file)["link"]
            self.assertEqual((link["unanswered"], link["not_durable"], link["given_up"],
                              link["resumed"], link["errors"]), (0, 0, 0, kills, {}), log)
        self.assertEqual(self.server.hash("block"), self.server.hash("whole"))


if __name__ == "__main__":
    run_tests()
