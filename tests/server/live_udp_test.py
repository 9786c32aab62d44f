# SPDX-License-Identifier: Apache-2.0
"""Tests UDP of a real server with a client that shares neither codec nor cipher with it."""
import json
import os
import random
import struct
import subprocess
import unittest

from datagram_client import UdpClient, NotAuthentic, aead_open, aead_seal, seal, unseal
from kept_logs import run_tests
from live_server import LiveTest, Server, until
from wire_client import PING, PONG, RESULT, Agent, header, motion_frame, parse_header, parse_result, sample

GAP = 8


def ping(time_us=7):
    return header(PING, 8) + struct.pack("<Q", time_us)


def counters(server):
    """Returns the datagram counters of /metrics."""
    text = server.http.request("GET", "/metrics")[2].decode()
    found = {}
    for line in text.splitlines():
        if line.startswith(("kerf_datagrams", "kerf_motion_gaps")):
            name, value = line.rsplit(" ", 1)
            found[name.replace('kerf_datagrams_dropped_total{reason="', "").replace('"}', "")] = float(value)
    return found


class UdpAgent(Agent):
    """Sends its first sample over the WebSocket, as the protocol requires, and the others over UDP."""

    def __init__(self, port, session="block"):
        super().__init__(port, session, udp=True)
        self.udp = UdpClient(self.welcome["udp"])
        self.move([(-10, 0, -2)])
        self.result()

    def samples(self, count):
        """Returns the next samples of a straight path along X."""
        made = []
        for _ in range(count):
            self.sequence += 1
            self.time_us += 1000
            made.append(sample(self.sequence, self.time_us, (-10 + 0.1 * self.sequence, 0, -2)))
        return made

    def answer(self):
        """Returns the next result over UDP."""
        while True:
            frame = self.udp.receive()
            if parse_header(frame)["type"] == RESULT:
                return parse_result(frame[32:])

    def is_silent(self):
        """Sends a ping behind the datagrams sent before; its pong must be the next datagram received."""
        self.udp.send(ping(99))
        frame = self.udp.receive()
        return parse_header(frame)["type"] == PONG and struct.unpack("<Q", frame[32:40])[0] == 99

    def close(self):
        if hasattr(self, "udp"):
            self.udp.close()
        super().close()


class Cipher(unittest.TestCase):
    """The cipher of these tests is that of RFC 8439, 2.8.2."""

    def test_example_of_the_rfc(self):
        key = bytes(range(0x80, 0xA0))
        nonce = bytes.fromhex("070000004041424344454647")
        head = bytes.fromhex("50515253c0c1c2c3c4c5c6c7")
        text = (b"Ladies and Gentlemen of the class of '99: If I could offer you only one tip for the "
                b"future, sunscreen would be it.")
        sealed = aead_seal(key, nonce, head, text)
        self.assertEqual(sealed[:16].hex(), "d31a8d34648e60db7b86afbc53ef7ec2")
        self.assertEqual(sealed[-16:].hex(), "1ae10b594f09e26a7e902ecbd0600691")
        self.assertEqual(aead_open(key, nonce, head, sealed), text)
        with self.assertRaises(NotAuthentic):
            aead_open(key, nonce, head, sealed[:-1] + bytes([sealed[-1] ^ 1]))


class Offer(LiveTest):
    def test_keys_are_offered_on_request_and_differ(self):
        self.assertNotIn("udp", Agent(self.port, "block").welcome)
        self.assertNotIn("udp", Agent(self.port, "block", udp=False).welcome)
        offers = [Agent(self.port, "block", udp=True).welcome["udp"] for _ in range(3)]
        self.assertEqual({offer["port"] for offer in offers}, {self.port})
        for field in ("connection", "key_to_server", "key_to_agent"):
            self.assertEqual(len({offer[field] for offer in offers}), 3)
        self.assertNotEqual(offers[0]["key_to_server"], offers[0]["key_to_agent"])

    def test_invalid_udp_field_is_rejected(self):
        agent = Agent(self.port, "block", hello=False)
        agent.send_json({"type": "hello", "name": "Ada", "udp": "yes"})
        self.assertEqual(agent.receive_json("error")["code"], "bad_message")

    def test_udp_off(self):
        other = Server(self.folder.name + "/off", "--udp", "off")
        try:
            other.create()
            self.assertNotIn("udp", Agent(other.port, "block", udp=True).welcome)
        finally:
            other.stop()

    def test_udp_port_option(self):
        other = Server(self.folder.name + "/own", "--udp", "127.0.0.1:0")
        try:
            other.create()
            agent = UdpAgent(other.port)
            self.assertNotEqual(agent.udp.to[1], 0)
            self.assertTrue(agent.is_silent())
        finally:
            other.stop()

    def test_port_in_use_is_an_error_only_if_named(self):
        with self.assertRaisesRegex(RuntimeError, "cannot listen for UDP on 127.0.0.1"):
            Server(self.folder.name + "/two", "--udp", f"127.0.0.1:{self.port}")
        for wrong in ("x", "1.2.3.4:", "70000", ":5", "-1"):
            with self.assertRaisesRegex(RuntimeError, "is not"):
                Server(self.folder.name + "/two", f"--udp={wrong}")

    def test_answers_come_from_the_address_that_the_agent_uses(self):
        for listen, hosts in (("0.0.0.0:0", ("127.0.0.1", "127.0.0.2")),
                              ("[::]:0", ("127.0.0.1", "127.0.0.3"))):
            other = Server(self.folder.name + "/all" + listen[:2], "--udp", listen)
            try:
                other.create()
                offer = Agent(other.port, "block", udp=True).welcome["udp"]
                client = UdpClient(offer)
                for host in hosts:
                    client.to = (host, offer["port"])
                    client.send(ping())
                    client.socket.settimeout(30)
                    self.assertEqual(client.socket.recvfrom(2048)[1], client.to)
                client.close()
            finally:
                other.stop()

    def test_keys_expire_with_the_websocket(self):
        agent = UdpAgent(self.port)
        self.assertTrue(agent.is_silent())
        agent.socket.shutdown(2)
        until(self, lambda: [p["name"] for p in self.server.info()["participants"]], [])
        before = counters(self.server)["unknown_connection"]
        agent.udp.send(ping())
        until(self, lambda: counters(self.server)["unknown_connection"] > before, True)
        self.assertIsNone(agent.udp.receive(timeout=0.2))


class Motions(LiveTest):
    def carve_over_web_socket(self, count):
        """Cuts the same path in another session; returns its hash."""
        self.server.create("other")
        agent = Agent(self.port, "other")
        agent.move([(-10, 0, -2)])
        for n in range(2, count + 1):
            agent.move([(-10 + 0.1 * n, 0, -2)])
        agent.result()
        return self.server.hash("other")

    def test_samples_are_cut_and_answered_over_udp(self):
        agent = UdpAgent(self.port)
        for n in range(60):
            agent.udp.send(motion_frame(agent.samples(1)))
            result = agent.answer()
            self.assertEqual((result["agent_sequence"], result["motions"]), (n + 2, n + 1))
        self.assertGreater(result["area"], 1)
        self.assertLess(result["fx"], 0)
        self.assertEqual(self.server.hash(), self.carve_over_web_socket(61))

    def test_nothing_is_cut_across_a_gap(self):
        agent = UdpAgent(self.port)
        first, lost, later = agent.samples(4), agent.samples(20), agent.samples(4)
        agent.udp.send(motion_frame(first))
        force = agent.answer()["fx"]
        before = self.server.hash()
        for _ in range(3):
            agent.udp.send(motion_frame(later))
            result = agent.answer()
            self.assertEqual((result["agent_sequence"], result["status"] & GAP), (5, GAP))
            self.assertEqual(result["fx"], force, "the result from before the gap is repeated")
        self.assertEqual(self.server.hash(), before)
        self.assertEqual(counters(self.server)["kerf_motion_gaps_total"], 3)
        # The agent sends again from the lost sample on; the server knows some of these samples.
        agent.udp.send(motion_frame(lost[:16]))
        self.assertEqual(agent.answer()["agent_sequence"], 21)
        agent.udp.send(motion_frame(lost[12:] + later))
        result = agent.answer()
        self.assertEqual((result["agent_sequence"], result["status"] & GAP), (29, 0))
        self.assertEqual(result["motions"], 28)
        self.assertEqual(self.server.hash(), self.carve_over_web_socket(29))

    def test_repeated_and_old_datagrams_have_no_effect(self):
        agent = UdpAgent(self.port)
        batches = [agent.samples(2) for _ in range(5)]
        for batch in batches:
            agent.udp.send(motion_frame(batch))
            newest = agent.answer()
        before = self.server.hash()
        for batch in reversed(batches):
            agent.udp.send(motion_frame(batch))
            result = agent.answer()
            self.assertEqual(result["agent_sequence"], 11)
            self.assertEqual(result["fx"], newest["fx"], "the result is sent again, in case it was lost")
        self.assertEqual((self.server.hash(), self.server.info()["motions"]), (before, 10))

    def test_first_sample_must_come_over_the_websocket(self):
        agent = Agent(self.port, "block", udp=True)
        client = UdpClient(agent.welcome["udp"])
        client.send(motion_frame([sample(1, 1000, (-10, 0, -2)), sample(2, 2000, (-9, 0, -2))]))
        result = parse_result(client.receive()[32:])
        self.assertEqual((result["agent_sequence"], result["status"] & GAP), (0, GAP))
        self.assertEqual(self.server.info()["motions"], 0)
        client.close()

    def test_samples_may_alternate_between_transports(self):
        agent = UdpAgent(self.port)
        rng = random.Random(5)
        for _ in range(40):
            batch = agent.samples(rng.randint(1, 4))
            transports = rng.choice([(True,), (False,), (True, False), (False, True)])
            for udp in transports:
                if udp:
                    agent.udp.send(motion_frame(batch))
                    self.assertEqual(agent.answer()["agent_sequence"], agent.sequence)
                else:
                    agent.send_binary(motion_frame(batch))
                    agent.result()
        self.assertEqual(self.server.info()["motions"], agent.sequence - 1)
        self.assertEqual(self.server.hash(), self.carve_over_web_socket(agent.sequence))


class Turns(LiveTest):
    """A batch over UDP that is cut in several turns, and frames over the WebSocket meanwhile."""

    WIDE = {"name": "wide", "stock": {"shape": "box", "min_mm": [-120, -120, -20], "max_mm": [120, 120, 0]},
            "accuracy": {"rays": "dexel", "pitch_mm": 0.2, "tolerance_mm": 0.01, "motion": "tight"},
            "tools": [{"id": 1, "shape": "flat", "diameter_mm": 200, "length_mm": 60},
                      {"id": 2, "shape": "flat", "diameter_mm": 60, "length_mm": 60}]}

    def carve(self, session, udp):
        """Four wide motions of tool 1, a change of the tool, and three of tool 2; returns what is left."""
        self.server.create(session, self.WIDE)
        agent = UdpAgent(self.port, session) if udp else Agent(self.port, session)
        if not udp:
            agent.move([(-10, 0, -2)])
        wide = [sample(n, agent.time_us + 1000 * n, (-10 + n, 0, -2 - 0.1 * n)) for n in range(2, 6)]
        narrow = [sample(n, agent.time_us + 1000 * n, (n, 10, -2 - n), tool=2) for n in range(6, 10)]
        if udp:
            agent.udp.send(motion_frame(wide))
            while self.server.info(session)["motions"] < 1:  # of four
                pass
        else:
            agent.send_binary(motion_frame(wide))
        agent.send_json({"type": "tool", "tool": 2})
        agent.send_binary(motion_frame(narrow))
        while agent.result()["agent_sequence"] != 9:
            pass
        return self.server.info(session)["motions"], self.server.hash(session)

    def test_tool_and_samples_wait_until_the_batch_is_cut(self):
        plain = self.carve("plain", False)
        self.assertEqual(plain[0], 4 + 3)
        self.assertEqual(self.carve("udp", True), plain)

    def test_the_answer_comes_over_udp_as_well(self):
        self.server.create("answer", self.WIDE)
        agent = UdpAgent(self.port, "answer")
        agent.udp.send(motion_frame([sample(2, agent.time_us + 1000, (-9, 0, -2))]))
        self.assertEqual(agent.answer()["agent_sequence"], 2)


class RealAgent(LiveTest):
    """Tests the messages of kerf-agent about UDP."""

    def run_agent(self, port, *more):
        path = os.path.join(self.folder.name, "path.csv")
        with open(path, "w") as file:
            file.write("t_s,x,y,z,i,j,k,cutting,tool\n")
            for n in range(9):
                file.write(f"{0.2 * n},{-10 + 2 * n},{n % 2},-2,0,0,1,1,1\n")
        done = subprocess.run(
            [os.environ["KERF_AGENT"], "--server", f"http://127.0.0.1:{port}", "--session", "block", "--device",
             f"replay:{path}", "--status-json", "-", *more], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)["link"], done.stderr

    def test_agent_uses_udp_on_request(self):
        link, _ = self.run_agent(self.port, "--udp")
        self.assertTrue(link["udp"]["offered"])
        self.assertGreater(link["udp"]["samples"], 0)
        self.assertEqual(link["unanswered"], 0)
        self.assertGreater(counters(self.server)["kerf_datagrams_received_total"], 0)
        link, _ = self.run_agent(self.port)
        self.assertFalse(link["udp"]["asked"])
        self.assertEqual(link["udp"]["datagrams_sent"], 0)

    def test_agent_stays_on_the_websocket_without_udp(self):
        other = Server(self.folder.name + "/off", "--udp", "off")
        try:
            other.create()
            link, said = self.run_agent(other.port, "--udp")
            self.assertIn("the server has no UDP transport", said)
            self.assertEqual((link["udp"]["asked"], link["udp"]["offered"], link["unanswered"]),
                             (True, False, 0))
        finally:
            other.stop()


class Strangers(LiveTest):
    """Datagrams that are not authentic are counted and have no other effect."""

    def test_answers_follow_the_newest_datagram(self):
        agent = UdpAgent(self.port)
        old = agent.udp.sealed(ping(1))
        self.assertTrue(agent.is_silent())
        stranger = UdpClient(agent.welcome["udp"])
        stranger.send_raw(old)  # delayed by an attacker and sent from another address
        self.assertIsNotNone(agent.udp.receive(), "answers go to the source of the newest datagram")
        self.assertIsNone(stranger.receive(timeout=0.2))
        agent.udp.move()
        self.assertTrue(agent.is_silent())
        agent.udp.send(motion_frame(agent.samples(2)))
        self.assertEqual(agent.answer()["agent_sequence"], 3)
        stranger.close()

    def test_tampered_and_malformed_datagrams(self):
        agent = UdpAgent(self.port)
        offer = agent.welcome["udp"]
        frame = motion_frame(agent.samples(1))
        good = agent.udp.sealed(frame)
        wrong = [b"", b"\0", good[:16], good[:32], good[:-1], good + b"\0", good + bytes(1400)]
        for at in range(len(good)):
            wrong.append(good[:at] + bytes([good[at] ^ 1 << at % 8]) + good[at + 1:])
        wrong.append(seal(agent.udp.key_in, offer["connection"], 50, frame))  # the key of the other direction
        wrong.append(seal(agent.udp.key_out, offer["connection"] ^ 1, 51, frame))
        rng = random.Random(1)
        for size in (1, 33, 40, 200, 1200, 1201, 1500):
            wrong.append(rng.randbytes(size))
            wrong.append((good[:16] + rng.randbytes(size))[:1472])
        before, hash_before = counters(self.server), self.server.hash()
        for datagram in wrong:
            agent.udp.send_raw(datagram)
        self.assertTrue(agent.is_silent(), "invalid datagrams are not answered")
        after = counters(self.server)
        reasons = ("malformed", "unknown_connection", "not_authentic", "replayed")
        self.assertEqual(sum(after[r] - before[r] for r in reasons), len(wrong))
        for reason in reasons[:3]:
            self.assertGreater(after[reason], before[reason])
        self.assertEqual(self.server.hash(), hash_before)
        # The authentic datagram is still accepted.
        agent.udp.send_raw(good)
        self.assertEqual(agent.answer()["agent_sequence"], 2)

    def test_a_replay_is_dropped(self):
        agent = UdpAgent(self.port)
        datagram = agent.udp.sealed(motion_frame(agent.samples(1)))
        for _ in range(20):
            agent.udp.send_raw(datagram)
        self.assertEqual(agent.answer()["agent_sequence"], 2)
        self.assertTrue(agent.is_silent())
        self.assertEqual(counters(self.server)["replayed"], 19)

    def test_authentic_but_malformed_frame_is_an_error(self):
        agent = UdpAgent(self.port)
        for frame in (b"x", bytes(40), motion_frame(agent.samples(1))[:-8], header(77, 0)):
            agent.udp.send(frame)
        self.assertTrue(agent.is_silent())
        for _ in range(3):
            self.assertEqual(agent.receive_json("error")["code"], "bad_frame")

    def test_flood_is_bounded_and_does_not_affect_others(self):
        agent, other = UdpAgent(self.port), Agent(self.port, "block", "Grace")
        datagrams = [agent.udp.sealed(ping(n)) for n in range(4000)]
        for n, datagram in enumerate(datagrams):
            agent.udp.send_raw(datagram)
            agent.udp.send_raw(datagram)
            if n % 100 == 0:
                other.move([(5 + 0.01 * n, 5, -1)])
                other.result()
        until(self, lambda: counters(self.server)["replayed"] > 0, True)
        self.assertEqual(self.server.http.json("GET", "/v1/sessions/block")[0], 200)
        agent.udp.move()
        while agent.udp.receive(timeout=0.05) is None:
            agent.udp.send(ping(99))


if __name__ == "__main__":
    run_tests()
