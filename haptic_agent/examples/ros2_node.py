#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""ros2_node.py: a ROS 2 node whose poses carve in a Kerf session. Topics, parameters: ros2.md."""
import ctypes
import time
from ctypes import byref, c_char_p, c_double, c_void_p

import rclpy
from geometry_msgs.msg import PoseStamped, WrenchStamped
from rclpy.node import Node
from std_msgs.msg import Bool, Empty

from press import CUT, READY, Capabilities, Options, Pose, Session, Wrench, load

MM_PER_M = 1000.0
POSE_LIFE_S = 0.02


class KerfNode(Node):
    def __init__(self):
        super().__init__("kerf")
        given = {name: self.declare_parameter(name, default).value for name, default in (
            ("server", "http://localhost:8080"), ("session", "ammonite"), ("max_force_n", 5.0),
            ("library", ""), ("frame", "base"), ("latency_ms", 5.0))}
        self.kerf = kerf = load(given["library"])
        kerf.kerf_agent_last_error.restype = c_char_p
        kerf.kerf_agent_close.argtypes = [c_void_p, c_double]
        device = Capabilities(name=b"ros2", sensed_dof=5, actuated_dof=3,
                              max_force_n=given["max_force_n"],
                              latency_us=int(given["latency_ms"] * 1000))
        options = Options(server=given["server"].encode(), session=given["session"].encode(),
                          name=b"ROS 2", device=ctypes.pointer(device))
        self.agent, self.session, self.pose, self.wrench = c_void_p(), Session(), Pose(), Wrench()
        if kerf.kerf_agent_connect(byref(options), byref(self.agent)) != 0:
            raise RuntimeError(kerf.kerf_agent_last_error().decode())
        kerf.kerf_agent_get_session(self.agent, byref(self.session))
        self.heard_s, self.message = 0.0, WrenchStamped()
        self.message.header.frame_id = given["frame"]
        self.output = self.create_publisher(WrenchStamped, "~/wrench", 1)
        self.create_subscription(PoseStamped, "~/pose", self.take_pose, 1)
        self.create_subscription(Bool, "~/cut", self.take_cut, 1)
        self.create_subscription(Empty, "~/rearm", lambda _: kerf.kerf_agent_rearm(self.agent), 1)
        self.create_timer(1e-3, self.tick)

    def take_pose(self, message):
        p, q = message.pose.position, message.pose.orientation
        axis = (2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x),
                1 - 2 * (q.x * q.x + q.y * q.y))
        self.pose.axis[:] = axis
        self.pose.tip_mm[:] = [MM_PER_M * at - self.session.pivot_mm * a
                               for at, a in zip((p.x, p.y, p.z), axis)]
        self.heard_s = time.monotonic()

    def take_cut(self, message):
        self.pose.buttons = CUT if message.data else 0

    def tick(self):
        self.pose.state = READY if time.monotonic() - self.heard_s < POSE_LIFE_S else 0
        self.kerf.kerf_agent_step(self.agent, byref(self.pose), byref(self.wrench))
        self.message.header.stamp = self.get_clock().now().to_msg()
        force, torque = self.message.wrench.force, self.message.wrench.torque
        force.x, force.y, force.z = self.wrench.force_n
        torque.x, torque.y, torque.z = (t / MM_PER_M for t in self.wrench.torque_nmm)
        self.output.publish(self.message)


def main():
    rclpy.init()
    node = KerfNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.kerf.kerf_agent_close(node.agent, 2.0)
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
