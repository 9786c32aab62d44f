# SPDX-License-Identifier: Apache-2.0
"""Stands in for geometry_msgs.msg: messages with the fields of ROS 2, and no others."""


def fields(name, **kinds):
    def init(self):
        for field, kind in kinds.items():
            object.__setattr__(self, field, kind())
    return type(name, (), {"__slots__": tuple(kinds), "__init__": init})


Vector3 = fields("Vector3", x=float, y=float, z=float)
Quaternion = fields("Quaternion", x=float, y=float, z=float, w=float)
Header = fields("Header", stamp=float, frame_id=str)
PoseBody = fields("Pose", position=Vector3, orientation=Quaternion)
WrenchBody = fields("Wrench", force=Vector3, torque=Vector3)
PoseStamped = fields("PoseStamped", header=Header, pose=PoseBody)
WrenchStamped = fields("WrenchStamped", header=Header, wrench=WrenchBody)
