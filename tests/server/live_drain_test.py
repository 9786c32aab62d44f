# SPDX-License-Identifier: Apache-2.0
"""A server that is drained sends its peers to the one that takes its data folder."""
import json
import os
import subprocess
import tempfile

from kept_logs import keep, run_tests
from live_agent_test import AGENT, rows
from live_server import LiveTest, Server, until
from wire_client import Viewer


class Drain(LiveTest):
    def run_agent(self, port, session):
        path = os.path.join(self.folder.name, session + ".csv")
        with open(path, "w", encoding="ascii") as file:
            file.write(rows(120.0))  # long enough for all agents to cut at the same time
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
            for session in ("block", "other"):  # wait until they are in the middle of their cuts
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


if __name__ == "__main__":
    run_tests()
