#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Serves a Haply Inverse3, with a VerseGrip if there is one, to `kerf-agent --device socket:`.

Exchanges positions and forces with the Haply Inverse Service (its simulation channel, versions 3.1
to 3.5) and lines with the agent (haptic_agent/device/socket/README.md). See README.md here."""
import argparse
import base64
import hashlib
import json
import math
import os
import socket
import stat
import struct
import sys
import time
from urllib.parse import urlsplit

MM_PER_M, PERIOD_S = 1000.0, 1e-3
WRENCH_LIFE_S = 0.02  # a wrench that the agent has not renewed for this time ends
MOST_M = 100.0  # a cursor farther away is an error of the service
SERVICE_QUIET_S = 0.5  # a service that does not answer for this time is lost
RETRY_S, START_ABOVE_MM = 0.5, 10.0
WORDS = ("vector", "values")  # names of the force in set_cursor_force: of 3.5, and of 3.1
# A force of LEAST_N or more must be reported within UNTAKEN_S, at least ECHO_SHARE of it.
LEAST_N, ECHO_SHARE, UNTAKEN_S = 0.1, 0.05, 0.15
RAMP_S = 0.5  # time in which the force rises after its name has been changed
BUTTONS = (1, 1024, 256)  # bits of a pose for the grip's a, b, c: cut, re-arm, undo
GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # RFC 6455
TEXT, CLOSE, PING, PONG = 1, 8, 9, 10


class Lost(Exception):
    """The connection to the service or the agent is lost; the text is the reason."""


# Raised for invalid messages of the service or the agent, whose connection is then lost.
FAULTS = (Lost, OSError, ValueError, LookupError, TypeError, AttributeError, OverflowError)


class Service:
    """The simulation channel: one state comes back for each message sent."""

    def __init__(self, url):
        parts = urlsplit(url)
        if parts.scheme != "ws" or not parts.hostname:
            raise ValueError(f"{url} is not an address such as ws://localhost:10001")
        port = parts.port or 10001
        self.pending = b""
        try:
            self.socket = socket.create_connection((parts.hostname, port), timeout=SERVICE_QUIET_S)
        except OSError as gone:
            raise Lost(f"the Inverse Service at {url} cannot be reached ({gone}); start Haply Hub, "
                       "or name another address with --service") from None
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET {parts.path or '/'} HTTP/1.1\r\nHost: {parts.hostname}:{port}\r\n"
            f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
            f"Sec-WebSocket-Version: 13\r\n\r\n".encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self._read(1)
        accept = base64.b64encode(hashlib.sha1((key + GUID).encode()).digest())
        if b" 101 " not in head.split(b"\r\n")[0] + b" " or accept not in head:
            raise Lost("it is not a WebSocket service")

    def close(self):
        self.socket.close()

    def send(self, message):
        self._frame(TEXT, json.dumps(message).encode())

    def receive(self):
        """Returns the next message."""
        whole = b""
        while True:
            first, second = self._read(2)
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack(">H", self._read(2))
            elif size == 127:
                size, = struct.unpack(">Q", self._read(8))
            if second & 0x80 or size > 1 << 20:
                raise Lost("it sent a malformed frame")
            data, kind = self._read(size), first & 0x0F
            if kind == CLOSE:
                raise Lost("it closed the connection")
            if kind == PING:
                self._frame(PONG, data)
            elif kind <= 2:
                whole += data
                if first & 0x80:
                    return message_of(whole)

    def _frame(self, kind, data):
        mask = os.urandom(4)
        size = len(data)
        head = struct.pack(">BB", 0x80 | kind, 0x80 | size) if size < 126 else struct.pack(
            ">BBH", 0x80 | kind, 0x80 | 126, size)
        self.socket.sendall(head + mask + bytes(b ^ mask[i & 3] for i, b in enumerate(data)))

    def _read(self, size):
        while len(self.pending) < size:
            got = self.socket.recv(65536)
            if not got:
                raise Lost("it closed the connection")
            self.pending += got
        data, self.pending = self.pending[:size], self.pending[size:]
        return data


def message_of(text):
    """Returns the JSON object of a message."""
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        raise Lost("it sent a message that is not JSON") from None
    if not isinstance(message, dict):
        raise Lost("it sent a message that is no object")
    return message


def position_of(value):
    """Returns {"x", "y", "z"}, m. Raises ValueError if one is no number or beyond MOST_M."""
    numbers = [float(value[name]) for name in "xyz"]
    if not all(abs(number) <= MOST_M for number in numbers):
        raise ValueError("the position is out of range")
    return numbers


def axis_of(quaternion, sign):
    """Returns the unit axis of the tool: `sign` times the grip's local +Y, its direction."""
    w, x, y, z = (float(quaternion[name]) for name in "wxyz")
    norm = w * w + x * x + y * y + z * z
    if not (math.isfinite(norm) and norm > 1e-6):
        raise ValueError("not a rotation")
    s = 2 * sign / norm
    return [s * (x * y - w * z), sign - s * (x * x + z * z), s * (y * z + w * x)]


class ForceWord:
    """The name of the force in a command. The service silently ignores any other name: version 3.5,
    whose messages state a `session_id`, expects `vector`, 3.1 `values`. If its
    `current_cursor_force` stays zero while a force is commanded, the other name is tried."""

    def __init__(self, inventory):
        self.guess = self.word = WORDS["session_id" not in inventory]
        self.confirmed, self.unheard_s, self.rise_from_s = False, None, None

    def scale(self, now_s):
        """Factor of the force, which rises from zero after the name has been changed."""
        return 1.0 if self.rise_from_s is None else min(1.0, (now_s - self.rise_from_s) / RAMP_S)

    def judge(self, now_s, commanded, reported):
        """Compares commanded and reported force, N; returns a line for the user or ""."""
        newtons = math.hypot(*commanded)
        if reported is None or newtons < LEAST_N or math.hypot(*reported) > ECHO_SHARE * newtons:
            self.confirmed |= reported is not None and newtons >= LEAST_N
            self.unheard_s = None
            return ""
        self.unheard_s = self.unheard_s or now_s
        if now_s - self.unheard_s < UNTAKEN_S:
            return ""
        if self.confirmed:
            return "the Inverse Service no longer carries out the force; see Haply Hub"
        if self.rise_from_s is None:
            self.unheard_s, self.rise_from_s = None, now_s
            self.word = WORDS[self.guess == WORDS[0]]
            return f"the Inverse Service ignores '{self.guess}'; the force is sent as '{self.word}'"
        self.word = self.guess
        return ("the Inverse Service takes no force, named 'vector' or 'values': nothing is felt; "
                "update Haply Hub, and see in it whether the device is ready")


class Inverse3:
    """Reads one Inverse3 and one grip out of the service's states."""

    def __init__(self, inventory, axis_sign):
        devices = inventory.get("inverse3") or []
        if not devices:
            raise Lost("it has no Inverse3")
        self.device_id = devices[0]["device_id"]
        self.axis_sign = axis_sign
        self.grip_kind = next((kind for kind in ("wireless_verse_grip", "verse_grip",
                                                 "custom_verse_grip") if inventory.get(kind)), None)
        self.position, self.axis, self.buttons, self.state = [0.0] * 3, [0.0, 0.0, 1.0], 0, "homing"
        self.word, self.reported_n, self.said = ForceWord(inventory), None, set()

    def take(self, message):
        """Processes a state update. A device missing from it is absent."""
        if message.get("error"):
            self.say(f"the Inverse Service reports: {str(message['error'])[:200]}")
        device = next((d for d in message.get("inverse3") or []
                       if d.get("device_id") == self.device_id), None)
        if device is None:
            self.state = "absent"
            return
        status = device.get("status") or {}
        self.state = "homing" if status.get("calibrated") is False else "ready"
        self.position = [MM_PER_M * v for v in position_of(device["state"]["cursor_position"])]
        reported = device["state"].get("current_cursor_force")
        self.reported_n = reported and [float(reported[name]) for name in "xyz"]
        grips = message.get(self.grip_kind) or [] if self.grip_kind else []
        if grips:
            state = grips[0]["state"]
            self.axis = axis_of(state["orientation"], self.axis_sign)
            pressed = state.get("buttons") or {}
            held = (state.get("button") or pressed.get("a"), pressed.get("b"), pressed.get("c"))
            self.buttons = sum(bit for bit, on in zip(BUTTONS, held) if on)
        elif self.grip_kind:
            self.buttons = 0

    def command(self, force_n):
        commands = {"set_cursor_force": {self.word.word: dict(zip("xyz", force_n))}}
        return {"inverse3": [{"device_id": self.device_id, "commands": commands}]}

    def say(self, line):
        """Prints a line for the user, each line once."""
        if line and line not in self.said:
            print(line, file=sys.stderr, flush=True)
        self.said.add(line)


def hello(device, handshake):
    """The first message: states who this is, and commands no force."""
    return {"session": {"configure": {"profile": {"name": handshake}}}, **device.command([0.0] * 3)}


class Agent:
    """The connection of kerf-agent."""

    def __init__(self, connection, capabilities):
        self.socket = connection
        self.pending, self.number, self.force_n, self.renewed_s = b"", 0, [0.0] * 3, 0.0
        connection.sendall(capabilities.encode())
        connection.settimeout(5)
        while b"\n" not in self.pending:
            self._read()
        line, self.pending = self.pending.split(b"\n", 1)
        words = line.split()
        if len(words) != 9 or words[0] != b"session":
            raise Lost("it is no kerf-agent")
        self.pivot_mm, x0, y0, _, x1, y1, z1 = map(float, words[2:])
        self.start_mm = [(x0 + x1) / 2, (y0 + y1) / 2, z1 + START_ABOVE_MM]
        connection.setblocking(False)

    def wrench(self, now_s):
        """Returns the newest force and its number; no force if the agent has not renewed it."""
        try:
            while True:
                self._read()
        except BlockingIOError:
            pass
        *lines, self.pending = self.pending.split(b"\n")
        if lines:
            words = lines[-1].split()
            self.number, self.force_n = int(words[1]), [float(word) for word in words[2:5]]
            self.renewed_s = now_s
        return (self.force_n if now_s - self.renewed_s <= WRENCH_LIFE_S else [0.0] * 3), self.number

    def pose(self, state, tip_mm, axis, buttons, accepted):
        place = " ".join([*(f"{v:.6f}" for v in tip_mm), *(f"{v:.9f}" for v in axis)])
        try:
            self.socket.send(f"pose {state} {place} {buttons} {accepted}\n".encode())
        except BlockingIOError:
            raise Lost("it does not read") from None

    def _read(self):
        got = self.socket.recv(65536)
        if not got:
            raise Lost("it left")
        self.pending += got


def run(service, device, agent):
    """Exchanges states and forces until one side is lost. The cursor holds the tool at its pivot.
    Its position when the device becomes ready puts the tip START_ABOVE_MM above the stock."""
    offset, due_s = None, time.monotonic()
    while True:
        now_s = time.monotonic()
        force_n, accepted = agent.wrench(now_s)
        scale = device.word.scale(now_s) if device.state == "ready" else 0.0
        sent_n = [scale * f for f in force_n]
        service.send(device.command(sent_n))
        device.take(service.receive())
        device.say(device.word.judge(now_s, sent_n, device.reported_n))
        if device.state == "ready" and offset is None:
            pivot = [s + agent.pivot_mm * a for s, a in zip(agent.start_mm, device.axis)]
            offset = [p - c for p, c in zip(pivot, device.position)]
        tip = [c + o - agent.pivot_mm * a
               for c, o, a in zip(device.position, offset or [0.0] * 3, device.axis)]
        agent.pose(device.state, tip, device.axis, device.buttons, accepted)
        due_s = max(due_s + PERIOD_S, time.monotonic() - PERIOD_S)
        time.sleep(max(0.0, due_s - time.monotonic()))


def open_service(options):
    """Connects; tells the service the name of this program and commands no force."""
    service = Service(options.service)
    try:
        device = Inverse3(service.receive(), options.axis_sign)
        service.send(hello(device, options.profile))
        device.take(service.receive())
        return service, device
    except BaseException:
        service.close()
        raise


def capabilities(device, options):
    dof = 5 if device.grip_kind else 3
    return (f"kerf-device 1 name=haply_inverse3 sensed_dof={dof} actuated_dof=3 "
            f"max_force_n={options.max_force:g} max_stiffness_n_per_mm={options.max_stiffness:g} "
            f"latency_us={int(options.latency * 1000)}"
            f"{' always_cut=1' if options.cut == 'always' else ''}\n")


def serve(listener, options):
    """Serves one agent after another. While the service is away, no agent is accepted: kerf-agent
    then states that it waits."""
    said = ""
    while True:
        service = None
        try:
            service, device = open_service(options)
            print(f"{options.service}: Inverse3 {device.device_id}, "
                  f"{device.grip_kind or 'no grip'}; waiting for kerf-agent", flush=True)
            if not device.grip_kind and options.cut == "button":
                print("no button: the tool only touches; see --cut always", flush=True)
            said = ""
            connection = listener.accept()[0]
            with connection:
                service.close()  # its states waited: start with new ones
                service, device = open_service(options)
                run(service, device, Agent(connection, capabilities(device, options)))
        except FAULTS as loss:
            text = f"lost: {loss or type(loss).__name__}"
            if text != said:
                print(text, file=sys.stderr, flush=True)
            said = text
            time.sleep(RETRY_S)
        finally:
            if service is not None:
                stop(service, device)


def stop(service, device):
    """Commands no force if the service still listens, and exits."""
    try:
        service.send(device.command([0.0] * 3))
        service.receive()
    except FAULTS:
        pass
    service.close()


def listen(where):
    """Listens at a local port or at a path, where it may replace a socket but no file."""
    if where.isdigit():
        return socket.create_server(("localhost", int(where)))
    if os.path.lexists(where):
        if not stat.S_ISSOCK(os.lstat(where).st_mode):
            raise ValueError(f"{where} exists and is not a socket")
        os.unlink(where)
    return socket.create_server(where, family=socket.AF_UNIX)


def number_in(least, most):
    """Returns a check for the number of an option, which rejects NaN."""
    def check(text):
        try:
            if least <= float(text) <= most:
                return float(text)
        except ValueError:
            pass
        raise argparse.ArgumentTypeError(f"must be a number from {least} to {most}")
    return check


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("listen", metavar="PATH|PORT", help="where kerf-agent connects to")
    parser.add_argument("--service", default="ws://localhost:10001", metavar="URL",
                        help="the simulation channel of the Inverse Service (%(default)s)")
    parser.add_argument("--max-force", type=number_in(0, 100), default=5, metavar="N",
                        help="greatest force of the device (%(default)s); the agent uses 0.6 of it")
    parser.add_argument("--max-stiffness", type=number_in(0, 100), default=1, metavar="N_PER_MM",
                        help="stiffness that it renders stably (%(default)s)")
    parser.add_argument("--latency", type=number_in(0, 20), default=5, metavar="MS",
                        help="from a pose until its force acts (%(default)s); measure it with "
                        "kerf-agent doctor")
    parser.add_argument("--axis-sign", type=int, choices=(-1, 1), default=-1,
                        help="-1: the grip points from the spindle to the tip (%(default)s)")
    parser.add_argument("--cut", choices=("button", "always"), default="button",
                        help="with the grip's button a, or while the force is on (%(default)s)")
    parser.add_argument("--profile", default="org.kerf.agent:inverse3", help="name for Haply Hub")
    options = parser.parse_args()
    try:
        listener = listen(options.listen)
    except ValueError as fault:
        parser.error(str(fault))
    try:
        serve(listener, options)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
