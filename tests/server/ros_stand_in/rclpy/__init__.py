# SPDX-License-Identifier: Apache-2.0
"""Stands in for rclpy, as far as ros2_node.py uses it, with a driver on the other side: a simulated
hand that presses and cuts, as in press.py. There is no middleware."""
import os
import time

from std_msgs.msg import Empty

ATTEMPTS = 8  # a busy machine loses ticks, which trips the safety envelope


def init():
    pass


def try_shutdown():
    pass


class Hand:
    """A mass of 0.2 kg, pulled along a path by a spring of 0.5 N/mm with damping; mm."""

    def __init__(self, node):
        self.node, self.at, self.speed, self.force = node, [0.0, 0.0, 65.0], [0.0] * 3, [0.0] * 3
        self.most_n = self.most_nm = 0.0
        self.count = 0
        node.topics["~/wrench"].listener = self.feel

    def feel(self, message):
        f, t = message.wrench.force, message.wrench.torque
        assert message.header.frame_id == "base" and message.header.stamp > 0
        self.force = [f.x, f.y, f.z]
        self.most_n = max(self.most_n, sum(v * v for v in self.force) ** 0.5)
        self.most_nm = max(self.most_nm, abs(t.x), abs(t.y), abs(t.z))
        self.count += 1

    def move(self, t):
        """Waits 5 mm above the stock, sinks 7 mm, cuts along x from 1.6 s on."""
        aim = (10 * max(0.0, t - 1.6), 0.0, 65 - min(7.0, max(0.0, 10 * (t - 0.8))))
        for i in range(3):
            pull = 0.5 * (aim[i] - self.at[i]) - 0.02 * self.speed[i] + self.force[i]
            self.speed[i] += pull / 0.2e-3 * 1e-3
            self.at[i] += self.speed[i] * 1e-3
        pose = self.node.messages["~/pose"]()
        p, q = pose.pose.position, pose.pose.orientation
        p.x, p.y, p.z = (v / 1000 for v in self.at)
        q.x, q.y, q.z, q.w = 0.0, 0.0, 0.0, 1.0
        cut = self.node.messages["~/cut"]()
        cut.data = t >= 1.6
        self.node.callbacks["~/pose"](pose)
        self.node.callbacks["~/cut"](cut)


def spin(node):
    """Runs the node's timer every millisecond until the hand has felt the cut."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(30))
    except PermissionError:
        pass  # an ordinary thread loses ticks while the machine is busy
    hand = Hand(node)
    (period_s, tick), = node.timers
    assert period_s == 1e-3
    for _ in range(ATTEMPTS):
        hand.at, hand.speed = [0.0, 0.0, 65.0], [0.0] * 3
        begin_s = time.monotonic()
        for i in range(2200):
            time.sleep(max(0.0, begin_s + i * 1e-3 - time.monotonic()))
            hand.move(i * 1e-3)
            tick()
        if hand.most_n > 0.1:
            break
        node.callbacks["~/rearm"](Empty())
    print(f"greatest {hand.most_n:.3f} N, {hand.most_nm:.3f} Nm in {hand.count} messages")
