# SPDX-License-Identifier: Apache-2.0
"""A TCP relay that emulates a slow network on loopback, between a real server and real agents.

The model is that of tests/agent/stability/virtual_line.h, in real time: each direction delays data
by half the round trip, with jitter; a lost segment arrives one round trip later and delays all data
behind it, because TCP preserves the order; and the line may stall periodically.
"""
import asyncio
import contextlib
import dataclasses
import random
import threading

SEGMENT_BYTES = 1448  # payload of one Ethernet packet
RESEND_S = 0.01       # delay of a resent segment beyond the round trip


@dataclasses.dataclass(frozen=True)
class Line:
    """Properties of the emulated line. `jitter`: largest deviation of the delay, as a fraction of it;
    `loss`: fraction of the segments. The line stalls for `stall_s` at the end of every
    `stall_every_s`."""
    rtt_s: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    stall_s: float = 0.0
    stall_every_s: float = 2.0


class Direction:
    """Computes the arrival times in one direction."""

    def __init__(self, line, seed):
        self.line = line
        self.random = random.Random(seed)
        self.last_s = 0.0
        self.pieces = self.lost = self.stalled = 0

    def due(self, now_s, count):
        line = self.line
        delay = line.rtt_s / 2 * (1 + line.jitter * self.random.uniform(-1, 1))
        segments = -(-count // SEGMENT_BYTES)
        if self.random.random() > (1 - line.loss) ** segments:
            delay += line.rtt_s + RESEND_S
            self.lost += 1
        due_s = now_s + delay
        moving_s = line.stall_every_s - line.stall_s
        if line.stall_s > 0 and due_s % line.stall_every_s > moving_s:
            due_s += line.stall_every_s - due_s % line.stall_every_s
            self.stalled += 1
        self.pieces += 1
        self.last_s = max(self.last_s, due_s)
        return self.last_s


class Relay:
    """Listens on `port` and relays each connection to `target_port`, both on 127.0.0.1, inside a `with`
    statement. `up` is the direction to the target, `down` the opposite; their counters may be read
    after the statement."""

    def __init__(self, target_port, line, seed=1):
        self.up, self.down = Direction(line, seed), Direction(line, seed + 1)
        self._target_port = target_port
        self._loop = asyncio.new_event_loop()
        self._tasks = set()
        self._server = self._loop.run_until_complete(
            asyncio.start_server(self._relay, "127.0.0.1", 0))
        self.port = self._server.sockets[0].getsockname()[1]
        self._thread = threading.Thread(target=self._loop.run_forever)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result(30)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _end(self):
        self._server.close()
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _relay(self, reader, writer):
        """Relays both directions of one connection until both have ended."""
        self._tasks.add(asyncio.current_task())
        target = None
        try:
            back, target = await asyncio.open_connection("127.0.0.1", self._target_port)
            await asyncio.gather(self._pass(reader, target, self.up),
                                 self._pass(back, writer, self.down))
        except (OSError, asyncio.CancelledError):
            pass  # either end may close at any time
        finally:
            for end in (writer, target):
                if end is not None:
                    end.close()
            self._tasks.discard(asyncio.current_task())

    async def _pass(self, reader, writer, direction):
        """Reads without delay and writes when due; the end of the stream is delayed like data."""
        waiting = asyncio.Queue()
        writing = asyncio.ensure_future(self._write(waiting, writer))
        try:
            data = None
            while data != b"":
                data = await reader.read(SEGMENT_BYTES)
                await waiting.put((direction.due(self._loop.time(), len(data)), data))
            await writing
        finally:
            writing.cancel()
            with contextlib.suppress(OSError, asyncio.CancelledError):
                await writing

    async def _write(self, waiting, writer):
        while True:
            due_s, data = await waiting.get()
            await asyncio.sleep(max(0.0, due_s - self._loop.time()))
            if not data:
                writer.write_eof()
                return
            writer.write(data)
            await writer.drain()
