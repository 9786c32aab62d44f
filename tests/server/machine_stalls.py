# SPDX-License-Identifier: Apache-2.0
"""Tells a machine that stands still from a program that is late: counts the times at which a thread above
all others, on any processor, was woken 2 ms late or later."""
import os
import subprocess
import sys

# Above the threads of the agent (at most 90) and of the simulated device (95).
PRIORITY = 98
# Waking up this late loses a tick of a 1 kHz loop in any case.
STALL_S = 0.002

WATCH = f"""
import os, signal, sys, time
os.sched_setaffinity(0, {{int(sys.argv[1])}})
try:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({PRIORITY}))
except PermissionError:
    pass
signal.signal(signal.SIGTERM, lambda *_: sys.exit())
print("watching", flush=True)
due = time.monotonic() + 0.001
while True:
    time.sleep(max(due - time.monotonic(), 0))
    late = time.monotonic() - due
    if late > {STALL_S}:
        print(late, flush=True)
    due = time.monotonic() + 0.001
"""


class MachineStalls:
    """Watches every processor until end()."""

    def __init__(self):
        self.watches = [subprocess.Popen([sys.executable, "-c", WATCH, str(cpu)],
                                         stdout=subprocess.PIPE, text=True)
                        for cpu in sorted(os.sched_getaffinity(0))]
        for watch in self.watches:
            watch.stdout.readline()

    def end(self):
        """Stops watching and returns the stalls in seconds, longest first."""
        stalls = []
        for watch in self.watches:
            watch.terminate()
            stalls += [float(line) for line in watch.communicate()[0].split()]
        self.watches = []
        return sorted(stalls, reverse=True)


def succeeds(test, attempt, attempts=5):
    """Calls attempt(0), attempt(1) … until one returns true, and returns whether one did. Skips `test`
    if none did while the machine stood still in most of them: that says nothing about the agent."""
    stalled = 0
    for number in range(attempts):
        stalls = MachineStalls()
        test.addCleanup(stalls.end)
        done = attempt(number)
        stalled += bool(stalls.end())
        if done:
            return True
    if 2 * stalled > attempts:
        test.skipTest("this machine is too busy for a loop of 1 kHz: it stood still for 2 ms or longer "
                      f"in {stalled} of {attempts} attempts")
    return False
