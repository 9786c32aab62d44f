// SPDX-License-Identifier: Apache-2.0
// A line that delays all data, in each direction.

import { createServer, connect } from 'node:net';
import { atEnd } from './processes.mjs';

function carry(from, to, delayMs, isHeld = () => false) {
  from.on('data', (bytes) =>
    setTimeout(() => {
      if (to.writable && !isHeld()) to.write(bytes);
    }, delayMs),
  );
  from.on('end', () => setTimeout(() => to.end(), delayMs));
  from.on('error', () => to.destroy());
}

/** Returns the address of a line to the server at `base`, which is there until the test ends. */
export async function slowLine(base, delayMs) {
  const { hostname, port } = new URL(base);
  const ends = new Set();
  let held = false;
  const line = createServer((client) => {
    const server = connect(Number(port), hostname);
    ends.add(client).add(server);
    carry(client, server, delayMs);
    carry(server, client, delayMs, () => held);
  });
  await new Promise((resolve) => {
    line.listen(0, '127.0.0.1', resolve);
  });
  atEnd(() => {
    line.close();
    for (const end of ends) end.destroy();
  });
  return {
    base: `http://127.0.0.1:${line.address().port}`,
    /** From now on nothing of the server comes, until the line is cut. */
    hold: () => {
      held = true;
    },
    /** Breaks the connections that are open; new ones can be made. */
    cut: () => {
      held = false;
      for (const end of ends) end.destroy();
      ends.clear();
    },
  };
}
