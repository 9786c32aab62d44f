# SPDX-License-Identifier: Apache-2.0
"""A server that opens the journal of another kernel version carves it again and says so."""
import os
import sqlite3
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from kept_logs import run_tests  # noqa: E402
from live_server import LiveTest, Server  # noqa: E402
from live_session_test import Agent, carve  # noqa: E402


class KernelVersion(LiveTest):
    def restart(self):
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        self.server = Server(self.folder.name)
        self.port = self.server.port
        return log

    def execute(self, *statements):
        with sqlite3.connect(os.path.join(self.folder.name, "block.kerf")) as journal:
            for statement in statements:
                journal.execute(statement)
        journal.close()

    def test_old_journal_is_carved_again_with_a_log_line(self):
        agent = Agent(self.port, "block")
        carve(agent, 200)
        agent.close()
        expected = self.server.hash()
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        self.assertNotIn("carved again", log)
        # Version 1 had other hashes.
        self.execute("UPDATE kernel_versions SET version=1", "UPDATE state_hashes SET hash=2989")
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash(), expected)
        code, log = self.server.stop()
        self.assertEqual(code, 0, log)
        lines = [line for line in log.splitlines() if "carved again" in line]
        self.assertEqual(len(lines), 1, log)
        self.assertIn("session block: the journal is of kernel version 1; carved again with version",
                      lines[0])
        # From now on it is a journal of this version: nothing is said, and its hash is compared.
        self.server = Server(self.folder.name)
        self.assertEqual(self.server.hash(), expected)
        self.assertNotIn("carved again", self.restart())

    def test_wrong_hash_of_the_same_version_is_an_error(self):
        agent = Agent(self.port, "block")
        carve(agent, 200)
        agent.close()
        self.server.hash()
        self.server.stop()
        self.execute("UPDATE state_hashes SET hash=2989")
        self.server = Server(self.folder.name)
        log = self.restart()
        self.assertNotIn("carved again", log)
        self.assertIn("replay gives state hash", log)


if __name__ == "__main__":
    run_tests()
