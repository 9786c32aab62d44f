// SPDX-License-Identifier: Apache-2.0
// A real nats-server, and servers that share their sessions over it.

import assert from 'node:assert/strict';
import { accessSync, constants } from 'node:fs';
import { createConnection, createServer } from 'node:net';
import { delimiter, join } from 'node:path';
import { start, until } from './processes.mjs';
import { startEmptyServer } from './session.mjs';

/** Where the program is; null: it is not installed. */
export function findNats() {
  const folders = [...(process.env.PATH ?? '').split(delimiter), '/usr/sbin'];
  const isThere = (file) => {
    try {
      accessSync(file, constants.X_OK);
      return true;
    } catch {
      return false;
    }
  };
  return folders.map((folder) => join(folder, 'nats-server')).find(isThere) ?? null;
}

function freePort() {
  return new Promise((resolve, reject) => {
    const probe = createServer();
    probe.on('error', reject);
    probe.listen(0, '127.0.0.1', () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

function answers(port) {
  return new Promise((resolve) => {
    const socket = createConnection(port, '127.0.0.1');
    socket.on('connect', () => resolve(true));
    socket.on('error', () => resolve(false));
    socket.on('close', () => resolve(false));
    socket.on('connect', () => socket.destroy());
  });
}

/** Starts nats-server with JetStream; returns its address. */
export async function startNats(program, folder) {
  const port = await freePort();
  const nats = start(program, [
    ...['-js', '-sd', join(folder, 'nats')],
    ...['-a', '127.0.0.1', '-p', String(port)],
  ]);
  await until('nats-server', 30, () => {
    assert.equal(nats.code, undefined, `nats-server exited: ${nats.errors}`);
    return answers(port);
  });
  return `nats://127.0.0.1:${port}`;
}

/** Starts a server of the cluster, with data in a folder of its own. */
export function startNode(options, folder, nats, name, ...more) {
  const others = ['--nats', nats, '--node', name, ...more];
  return startEmptyServer({ ...options, others }, join(folder, name));
}
