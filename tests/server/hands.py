# SPDX-License-Identifier: Apache-2.0
"""What agents and programs of the live tests cut, and the header of a token."""
import math


def carve(agent, steps=400, phase=0.0):
    """Cuts along a spiral."""
    for i in range(steps):
        angle = phase + i * 0.02
        radius = 4 + 8 * i / steps
        agent.move([(radius * math.cos(angle), radius * math.sin(angle), -2 - i / steps)])
        agent.result()


def spiral(blocks):
    """A program with one cutting block a line."""
    lines = ["G21 G90 G17 G94", "T2 M6", "G0 X0 Y0 Z5", "G1 Z-2 F3000"]
    for n in range(blocks):
        angle, radius = n * 0.1, 2 + 12 * n / blocks
        lines.append(f"G1 X{radius * math.cos(angle):.3f} Y{radius * math.sin(angle):.3f} F6000")
    return "\n".join(lines + ["M2", ""])


def bearer(token):
    return {"Authorization": "Bearer " + token}
