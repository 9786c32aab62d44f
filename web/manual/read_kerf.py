#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the records of a .kerf file, a JSON object in each line: python3 read_kerf.py FILE"""
import json
import math
import sqlite3
import struct
import sys
import zlib

PIECES = {1: ('ball', '<2d'), 2: ('frustum', '<4d'), 3: ('arc', '<5d')}


class Size:
    """The parameter of the Golomb-Rice code of one kind of number."""
    def __init__(self):
        self.sum, self.count = 64, 1

    def low_bits(self):
        return next((n for n in range(48) if self.count << n >= self.sum), 48)

    def learn(self, value):
        self.sum, self.count = self.sum + min(value, 1 << 48), self.count + 1
        if self.count == 32:
            self.sum, self.count = self.sum // 2, 16


class Bits:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return sum((self.data[at >> 3] >> (7 - at % 8) & 1) << (self.at - 1 - at)
                   for at in range(self.at - count, self.at))

    def number(self, size):
        low, quotient = size.low_bits(), 0
        while quotient < 20 and not self.take(1):
            quotient += 1
        value = quotient << low | self.take(low) if quotient < 20 else self.take(self.take(6) + 1)
        size.learn(value)
        return value

    def offset(self, predicted, size):
        folded = self.number(size)
        return predicted + (folded >> 1 ^ -(folded & 1))


def nearest(x):
    """Rounds to the nearest integer, halves away from zero."""
    return int(math.copysign(math.floor(abs(x)) + (abs(x) % 1 >= 0.5), x))


class Participant:
    """The last motion of a participant, in steps of the pose grid."""
    def __init__(self):
        self.start, self.end, self.s, self.us, self.tool = [0] * 6, [0] * 6, 0.0, 0, 1
        self.sizes = [Size() for _ in range(9)]  # six coordinates, duration, start, tool

    def predict(self, i, us):
        step = nearest((self.end[i] - self.start[i]) * (us / self.us if self.us else 1.0))
        return step if abs(step) < 1e18 else 0

    def motion(self, bits, flags):
        tool = bits.number(self.sizes[8]) if flags & 16 else self.tool
        s, us = self.s, self.us
        if flags & 64:
            s = (struct.unpack('>d', bits.take(64).to_bytes(8, 'big'))[0] if flags & 128
                 else bits.offset(us, self.sizes[6]) * 1e-6)
            us = nearest(s * 1e6)
        start = [bits.offset(at, self.sizes[7]) if flags & 4 else at for at in self.end]
        end = list(start)
        for i in range(3 if flags & 8 else 5):
            end[i] = bits.offset(start[i] + self.predict(i, us), self.sizes[i])
        if not flags & 8:
            x, y = end[3] / 1e9, end[4] / 1e9
            z = nearest(math.sqrt(max(1 - x * x - y * y, 0)) * 1e9)
            end[5] = bits.offset(-z if start[5] < 0 else z, self.sizes[5])
        self.start, self.end, self.s, self.us, self.tool = start, end, s, us, tool
        return {'move': tool >> 1, 'from': pose(start), 'to': pose(end), 's': s,
                'force': tool & 1 == 1}


def pose(steps):
    return [step / (1e6 if i < 3 else 1e9) for i, step in enumerate(steps)]


def whole(data):
    """A command that is no motion on the pose grid."""
    if data[0] == 2:
        tool, *f, force = struct.unpack('<I13dB', data[1:])
        return {'move': tool, 'from': f[:6], 'to': f[6:12], 's': f[12], 'force': force == 1}
    if data[0] == 4:
        stroke, undone = struct.unpack('<QB', data[1:])
        return {'undo' if undone else 'redo': stroke}
    lists, at = [[], []], 5
    for pieces in lists[:1] if data[0] == 1 else lists:
        count, at = struct.unpack_from('<I', data, at)[0], at + 4
        for _ in range(count):
            name, fields = PIECES[data[at]]
            pieces.append([name, *struct.unpack_from(fields, data, at + 1)])
            at += 1 + struct.calcsize(fields)
    return {'tool': struct.unpack_from('<I', data, 1)[0], 'cutting': lists[0], 'other': lists[1]}


def records(path):
    file = sqlite3.connect(f'file:{path}?mode=ro', uri=True)
    version = file.execute('PRAGMA user_version').fetchone()[0]
    if version not in (1, 2):
        sys.exit(f'{path} has version {version} of the format; this program reads 1 and 2')
    tables = [name for name, in file.execute('SELECT name FROM sqlite_master')]
    if 'commands' in tables:
        yield from old_records(file)
    if 'batches' in tables:
        yield from batched_records(file, path)


def old_records(file):
    for number, who, data in file.execute(
            'SELECT sequence, participant, bytes FROM commands ORDER BY sequence'):
        yield {'record': number, 'participant': who, **whole(data)}


def batched_records(file, path):
    for first, count, wall_ms, span_ms, data, crc in file.execute(
            'SELECT first, count, wall_ms, span_ms, bytes, crc FROM batches ORDER BY first'):
        head = struct.pack('<QQqq', first, count, wall_ms, span_ms)
        if zlib.crc32(head + data) != crc % 2 ** 32:
            sys.exit(f'{path}: the records {first} to {first + count - 1} are damaged')
        bits, who = Bits(data), 0
        if bits.take(1):
            people, who_size, length, flags = {}, Size(), Size(), 0
        for n in range(count):
            flags = flags if bits.take(1) else bits.take(8)
            who = bits.number(who_size) if flags & 1 else who
            command = (whole(bytes(bits.take(8) for _ in range(bits.number(length)))) if flags & 2
                       else people.setdefault(who, Participant()).motion(bits, flags))
            yield {'record': first + n, 'ms': wall_ms + span_ms * n // max(count - 1, 1),
                   'participant': who, 'begins_stroke': flags & 32 != 0, **command}


if __name__ == '__main__':
    for record in records(sys.argv[1]):
        print(json.dumps(record))
