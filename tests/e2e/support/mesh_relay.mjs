// SPDX-License-Identifier: Apache-2.0
// A relay between a server and a page, which can withhold what the server sends of the surface.

import { createServer, request } from 'node:http';
import { WebSocket, WebSocketServer } from 'ws';
import { atEnd } from './processes.mjs';

const MESH = 3;

/** Whether a message of the protocol is a mesh frame. */
function isMesh(data, isBinary) {
  return isBinary && data.length > 4 && data[4] === MESH;
}

/** Returns the address of a relay to the server at `base`, which is there until the test ends. */
export async function meshRelay(base) {
  let isWithheld = false;
  let withheld = 0;
  const relay = createServer((asked, answer) => {
    const { method, headers, url } = asked;
    const passed = request(new URL(url, base), { method, headers }, (got) => {
      answer.writeHead(got.statusCode, got.headers);
      got.pipe(answer);
    });
    passed.on('error', () => answer.destroy());
    asked.pipe(passed);
  });
  const pages = new WebSocketServer({
    server: relay,
    handleProtocols: (protocols) => [...protocols][0],
  });
  pages.on('connection', (page, { url, headers }) => {
    const { host, origin } = headers;
    const address = new URL(url, base.replace('http', 'ws'));
    const server = new WebSocket(address, page.protocol, { headers: { host }, origin });
    const waiting = [];
    server.on('open', () => {
      for (const [data, binary] of waiting.splice(0)) server.send(data, { binary });
    });
    page.on('message', (data, binary) => {
      if (server.readyState === WebSocket.OPEN) server.send(data, { binary });
      else waiting.push([data, binary]);
    });
    server.on('message', (data, binary) => {
      if (!isWithheld || !isMesh(data, binary)) page.send(data, { binary });
      else withheld += 1;
    });
    for (const [one, other] of [
      [page, server],
      [server, page],
    ]) {
      one.on('close', () => other.terminate());
      one.on('error', () => other.terminate());
    }
  });
  await new Promise((resolve) => {
    relay.listen(0, '127.0.0.1', resolve);
  });
  atEnd(() => {
    for (const page of pages.clients) page.terminate();
    relay.closeAllConnections();
    relay.close();
  });
  return {
    base: `http://127.0.0.1:${relay.address().port}`,
    /** From now on no mesh frame is passed on, on any connection; or again all. */
    withhold: (isOn) => {
      isWithheld = isOn;
    },
    /** How many mesh frames were withheld. */
    withheld: () => withheld,
  };
}
