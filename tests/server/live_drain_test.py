# SPDX-License-Identifier: Apache-2.0
"""A server that is drained sends its peers to the one that takes its data folder."""
import json
import os
import signal
import subprocess
import tempfile

from delaying_relay import Line, Relay
from kept_logs import keep, run_tests
from live_agent_test import AGENT, rows
from live_server import LiveTest, Server, until
from wire_client import Agent, Viewer, WebSocket


class Drain(LiveTest):
    def run_agent(self, port, session):
        path = os.path.join(self.folder.name, session + ".csv")
        with open(path, "w", encoding="ascii") as file:
            file.write(rows(120.0))  # all agents cut for longer than one starts later
        return subprocess.Popen(
            [AGENT, "--server", f"http://127.0.0.1:{port}", "--session", session,
             "--name", session, "--device", "replay:" + path, "--tool", "2", "--status-json", "-"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def assert_lost_nothing(self, agent, resumed):
        out, log = agent.communicate(timeout=60)
        keep("agent", log)
        self.assertEqual(agent.returncode, 0, log)
        link = json.loads(out)["link"]
        self.assertEqual((link["unanswered"], link["not_durable"], link["given_up"],
                          link["resumed"], link["errors"]), (0, 0, 0, resumed, {}), log)

    def test_agents_at_1_khz_go_on_at_the_next_server_and_lose_nothing(self):
        address = f"http://127.0.0.2:{self.port}"
        self.server.stop()
        self.server = Server(self.folder.name, "--drain-to", address)
        self.server.create("other")
        viewer = Viewer(self.server.port, "block")
        with tempfile.TemporaryDirectory(prefix="kerf-test-") as folder:
            whole = Server(folder)
            whole.create("whole")
            agents = {"whole": self.run_agent(whole.port, "whole"),
                      "block": self.run_agent(self.server.port, "block"),
                      "other": self.run_agent(self.server.port, "other")}
            for session in ("block", "other"):  # they are in the middle of their cuts
                until(self, lambda name=session: self.server.info(name)["motions"] > 100, True)
            status, log = self.server.stop()
            self.assertEqual(status, 0, log)
            bye = viewer.receive_json("bye")
            self.assertEqual(bye["redirect"], address)
            self.assertIn(address, bye["reason"])
            self.server = Server(self.folder.name, port=self.port, host="127.0.0.2")
            for session, agent in agents.items():
                self.assert_lost_nothing(agent, int(session != "whole"))
            expected = whole.hash("whole")
            whole.stop()
        self.assertEqual([self.server.hash("block"), self.server.hash("other")],
                         [expected, expected])
        self.port = self.server.port

    def test_an_agent_that_is_offline_meanwhile_goes_on_without_a_gap(self):
        self.server.create("whole")
        with Relay(self.port, Line()) as line:
            agents = [self.run_agent(self.port, "whole"), self.run_agent(line.port, "block")]
            until(self, lambda: self.server.info("block")["motions"] > 100, True)
            line.cut()
            self.assert_lost_nothing(agents[0], 0)
            expected = self.server.hash("whole")
            self.assertNotEqual(self.server.hash("block"), expected, "the line was cut too late")
            carved = self.server.info("block")["motions"]
            status, log = self.server.stop()
            self.assertEqual(status, 0, log)
            self.server = Server(self.folder.name, port=self.port)
            self.assertEqual(self.server.info("block")["motions"], carved)
            line.mend()
            self.assert_lost_nothing(agents[1], 1)
        self.assertEqual(self.server.hash("block"), expected)

    def test_an_administrator_drains_by_a_request(self):
        for bad in ("", "?to=", "?to=elsewhere", "?to=http://a/b"):
            self.assertEqual(self.server.http.json("POST", "/v1/drain" + bad)[0], 400, bad)
        agent = Agent(self.port, "block")
        agent.move([(0, 0, -1), (1, 0, -1)])
        agent.result()
        status, body = self.server.http.json("POST", "/v1/drain?to=http://127.0.0.1:9")
        self.assertEqual((status, body), (202, {"to": "http://127.0.0.1:9"}))
        self.assertEqual(agent.receive_json("bye")["redirect"], "http://127.0.0.1:9")
        self.assertEqual(self.server.process.wait(timeout=60), 0)


if __name__ == "__main__":
    run_tests()
