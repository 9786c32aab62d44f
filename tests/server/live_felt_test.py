# SPDX-License-Identifier: Apache-2.0
"""What a user of the real kerf-agent feels through slow lines. A loop of 1 kHz that is late trips, and
then a test is run again: no other test may run beside these."""
from delaying_relay import Relay
from kept_logs import run_tests
from live_agent_test import BALL, FAR, FARTHER, AgentTest, spiral
from live_server import SCENE

TANK_MJ = 30
# Events that the load of the test machine causes, not the line.
BUSY_MACHINE = ("lost_ticks", "lost_ticks_in_a_row")
ATTEMPTS = 8


class ThroughASlowLine(AgentTest):
    def feel(self, line):
        """Carves through the line with a simulated hand; returns the summary of a run without safety trips."""
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
        # The displayed force came from the agent's replica and agrees with the server's later results.
        copy = status["copy"]
        self.assertGreater(copy["answered"], 0.7 * copy["samples"])
        self.assertGreater(copy["felt_ticks"], 0)
        self.assertGreater(copy["compared"], 0)
        # Aligned by the times of the samples, whatever the load; a replica without force has 1.
        self.assertLess(copy["error"], 0.3)
        self.assertEqual(copy["bad_patches"], 0)

    def test_cut_is_felt_without_energy_gain_at_100_ms_with_loss(self):
        self.check_felt(self.feel(FAR))

    def test_cut_is_felt_without_energy_gain_at_250_ms_with_stalls(self):
        self.check_felt(self.feel(FARTHER))


if __name__ == "__main__":
    run_tests()
