# SPDX-License-Identifier: Apache-2.0
"""Stands in for rclpy.node: keeps what a node creates, and calls it directly."""
import json
import os
import time
from types import SimpleNamespace


class Publisher:
    def __init__(self, kind):
        self.kind, self.listener = kind, None

    def publish(self, message):
        assert isinstance(message, self.kind)
        self.listener(message)


class Time:
    def to_msg(self):
        return time.time()


class Node:
    def __init__(self, name):
        self.name = name
        self.topics, self.callbacks, self.messages, self.timers = {}, {}, {}, []
        self.given = json.loads(os.environ["ROS_PARAMETERS"])

    def declare_parameter(self, name, default):
        value = self.given.get(name, default)
        assert type(value) is type(default), name
        return SimpleNamespace(value=value)

    def create_publisher(self, kind, topic, depth):
        assert depth == 1
        self.topics[topic] = Publisher(kind)
        return self.topics[topic]

    def create_subscription(self, kind, topic, callback, depth):
        assert depth == 1
        self.messages[topic], self.callbacks[topic] = kind, callback

    def create_timer(self, period_s, callback):
        self.timers.append((period_s, callback))

    def get_clock(self):
        return SimpleNamespace(now=Time)

    def destroy_node(self):
        self.timers.clear()
