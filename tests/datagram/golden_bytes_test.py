# SPDX-License-Identifier: Apache-2.0
"""The golden bytes of cipher_test.cpp, by an independent implementation: RFC 8439, and the datagrams of
server/wire/README.md.

It shares nothing with OpenSSL, which both programs use, and therefore detects a mistake that both make
alike.
"""
import os
import re
import struct
import unittest

CPP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cipher_test.cpp")
FRAME_MAGIC, DATAGRAM_MAGIC, PING = 0x3146524B, 0x3144524B, 6
MASK = 0xFFFFFFFF


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


def seal(key, connection, counter, frame):
    head = struct.pack("<IIQ", DATAGRAM_MAGIC, connection, counter)
    return head + aead_seal(key, struct.pack("<IQ", 0, counter), head, frame)


class GoldenBytes(unittest.TestCase):
    def test_the_cipher_is_that_of_the_rfc(self):
        """The example of RFC 8439, 2.8.2."""
        key = bytes(range(0x80, 0xA0))
        nonce = bytes.fromhex("070000004041424344454647")
        head = bytes.fromhex("50515253c0c1c2c3c4c5c6c7")
        text = (b"Ladies and Gentlemen of the class of '99: If I could offer you only one tip for the "
                b"future, sunscreen would be it.")
        sealed = aead_seal(key, nonce, head, text)
        self.assertEqual(sealed[:16].hex(), "d31a8d34648e60db7b86afbc53ef7ec2")
        self.assertEqual(sealed[-16:].hex(), "1ae10b594f09e26a7e902ecbd0600691")

    def test_the_bytes_are_those_of_the_cpp_test(self):
        with open(CPP, encoding="utf-8") as file:
            case = re.search(r"SealsTheGoldenBytes\).*?\n}", file.read(), re.DOTALL).group(0)
        golden = "".join(re.findall(r'"([0-9a-f]+)"', case))
        ping = struct.pack("<IBBHIIQQQ", FRAME_MAGIC, PING, 0, 32, 8, 3, 7, 123_456, 123_456)
        key = bytes(range(32))
        self.assertEqual(seal(key, 0xA1B2C3D4, 0x0102030405060708, ping).hex(), golden)


if __name__ == "__main__":
    unittest.main()
