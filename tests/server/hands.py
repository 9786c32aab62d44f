# SPDX-License-Identifier: Apache-2.0
"""What agents and programs of the live tests cut, and agents with a token."""
import math

from wire_client import Agent, WebSocket


def carve(agent, steps=400, phase=0.0):
    """Cuts along a spiral."""
    for i in range(steps):
        angle = phase + i * 0.02
        radius = 4 + 8 * i / steps
        agent.move([(radius * math.cos(angle), radius * math.sin(angle), -2 - i / steps)])
        agent.result()


def stroke(agent, y, depth=-3, count=40):
    """A line along x; the tool is lifted afterwards."""
    agent.move([(-15, y, 1)], buttons=0)
    agent.result()
    agent.move([(-15, y, 0.5)], buttons=0)
    for first in range(0, count, 8):
        agent.move([(-15 + 30 * n / count, y, depth * min(1, n / 4))
                    for n in range(first, first + 8)])
        agent.result()
    agent.move([(15, y, 1)], buttons=0)
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


class Holder(Agent):
    """An agent that presents a token when it asks for its WebSocket."""

    def __init__(self, port, token, name="Ada"):
        WebSocket.__init__(self, port, "/v1/sessions/block/agent", "kerf.agent.v1",
                           [f"Authorization: Bearer {token}"])
        self.sequence = 0
        self.time_us = 1_000_000
        self.send_json({"type": "hello", "name": name})
        self.welcome = self.receive_json("welcome")
        self.participant = self.welcome["participant"]
        self.epoch = self.welcome["epoch"]
