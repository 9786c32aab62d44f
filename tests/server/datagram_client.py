# SPDX-License-Identifier: Apache-2.0
"""Independent implementation of an agent's UDP transport: RFC 8439 and the datagrams of server/wire/README.md.

ChaCha20-Poly1305 in plain Python is slow (one to two milliseconds per datagram) but shares nothing with OpenSSL, which
both programs use. It therefore detects a mistake that both programs make alike.
"""
import socket
import struct

MAGIC = 0x3144524B
MASK = 0xFFFFFFFF


class NotAuthentic(Exception):
    pass


def _block(key, counter, nonce):
    state = list(struct.unpack("<16I", b"expand 32-byte k" + key + struct.pack("<I", counter) + nonce))
    x = state[:]

    def turn(a, b, c, d):
        x[a] = (x[a] + x[b]) & MASK
        x[d] ^= x[a]
        x[d] = (x[d] << 16 | x[d] >> 16) & MASK
        x[c] = (x[c] + x[d]) & MASK
        x[b] ^= x[c]
        x[b] = (x[b] << 12 | x[b] >> 20) & MASK
        x[a] = (x[a] + x[b]) & MASK
        x[d] ^= x[a]
        x[d] = (x[d] << 8 | x[d] >> 24) & MASK
        x[c] = (x[c] + x[d]) & MASK
        x[b] ^= x[c]
        x[b] = (x[b] << 7 | x[b] >> 25) & MASK

    for _ in range(10):
        for n in range(4):
            turn(n, n + 4, n + 8, n + 12)
        for n in range(4):
            turn(n, 4 + (n + 1) % 4, 8 + (n + 2) % 4, 12 + (n + 3) % 4)
    return struct.pack("<16I", *((a + b) & MASK for a, b in zip(x, state)))


def _stream(key, nonce, data):
    stream = b"".join(_block(key, 1 + n, nonce) for n in range((len(data) + 63) // 64))
    return bytes(a ^ b for a, b in zip(data, stream))


def _tag(key, nonce, head, sealed):
    one_time = _block(key, 0, nonce)[:32]
    r = int.from_bytes(one_time[:16], "little") & 0x0FFFFFFC0FFFFFFC0FFFFFFC0FFFFFFF
    s = int.from_bytes(one_time[16:], "little")
    text = (head + bytes(-len(head) % 16) + sealed + bytes(-len(sealed) % 16) +
            struct.pack("<QQ", len(head), len(sealed)))
    total = 0
    for n in range(0, len(text), 16):
        total = (total + int.from_bytes(text[n:n + 16] + b"\x01", "little")) * r % ((1 << 130) - 5)
    return ((total + s) % (1 << 128)).to_bytes(16, "little")


def aead_seal(key, nonce, head, plain):
    sealed = _stream(key, nonce, plain)
    return sealed + _tag(key, nonce, head, sealed)


def aead_open(key, nonce, head, sealed):
    if _tag(key, nonce, head, sealed[:-16]) != sealed[-16:]:
        raise NotAuthentic()
    return _stream(key, nonce, sealed[:-16])


def seal(key, connection, counter, frame):
    head = struct.pack("<IIQ", MAGIC, connection, counter)
    return head + aead_seal(key, struct.pack("<IQ", 0, counter), head, frame)


def unseal(key, connection, datagram):
    """Returns the counter and the decrypted frame of a datagram."""
    magic, to, counter = struct.unpack("<IIQ", datagram[:16])
    assert magic == MAGIC and to == connection
    return counter, aead_open(key, struct.pack("<IQ", 0, counter), datagram[:16], datagram[16:])


class UdpClient:
    """An agent's UDP socket, from the `udp` of its welcome."""

    def __init__(self, offer, host="127.0.0.1"):
        assert offer["cipher"] == "chacha20-poly1305"
        self.to = (host, offer["port"])
        self.connection = offer["connection"]
        self.key_out = bytes.fromhex(offer["key_to_server"])
        self.key_in = bytes.fromhex(offer["key_to_agent"])
        self.counter = 0
        self.move()

    def move(self):
        """Changes the local port, as behind a NAT that lost its mapping."""
        if hasattr(self, "socket"):
            self.socket.close()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))

    def sealed(self, frame):
        self.counter += 1
        return seal(self.key_out, self.connection, self.counter, frame)

    def send(self, frame):
        self.send_raw(self.sealed(frame))

    def send_raw(self, datagram):
        self.socket.sendto(datagram, self.to)

    def receive(self, timeout=30):
        """Returns the next frame; None if none arrives in time."""
        self.socket.settimeout(timeout)
        try:
            return unseal(self.key_in, self.connection, self.socket.recv(2048))[1]
        except TimeoutError:
            return None

    def close(self):
        self.socket.close()
