// SPDX-License-Identifier: Apache-2.0
// A substitute for kerf-server: serves the built viewer, the list of sessions and one session, by
// the documented protocol. For developing and testing the viewer; the end-to-end test uses the real
// server.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { WebSocketServer } from 'ws';
import { FakeBlock } from './fake_block.mjs';
import { writeMeshGlb } from './glb.mjs';

const STEP_MM = 1 / 512;
const NAME_BYTES_MAX = 64;
const TYPES = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
  '.woff2': 'font/woff2',
};
const TOOLS = [
  { id: 1, shape: 'ball', diameter_mm: 10, length_mm: 40 },
  { id: 2, shape: 'taper', diameter_mm: 4, half_angle_deg: 8, length_mm: 40, tip: 'ball' },
];

export class FakeServer {
  constructor({ root = '', pitchMm = 0.5, hz = 30, agents = 2 } = {}) {
    Object.assign(this, { root, hz });
    this.block = new FakeBlock({ pitchMm });
    this.viewers = new Set();
    this.motions = 0;
    this.time = 0;
    this.sequence = { 3: 0, 4: 0, 7: 0 };
    this.agents = [
      {
        participant: 1,
        name: 'Ada',
        color: '#c2410c',
        tool: 1,
        kind: 'agent',
        radius: 5,
        petals: 5,
        reach: 38,
        phase: 0,
      },
      {
        participant: 2,
        name: 'Linus',
        color: '#0f766e',
        tool: 2,
        kind: 'agent',
        radius: 2,
        petals: 3,
        reach: 26,
        phase: 2.1,
      },
    ].slice(0, agents);
    this.acks = [];
    this.hellos = [];
    this.refusedName = null; // refused like one that is too long
    this.lookMessages = [];
    this.firstLooks = [];
  }

  async listen(port = 0) {
    this.http = createServer((request, response) => void this.answer_(request, response));
    this.sockets = new WebSocketServer({
      noServer: true,
      handleProtocols: (offered) => offered.has('kerf.view.v1') && 'kerf.view.v1',
    });
    this.http.on('upgrade', (request, socket, head) => {
      if (!request.url.startsWith('/v1/sessions/demo/view')) {
        socket.end('HTTP/1.1 404 Not Found\r\n\r\n');
        return;
      }
      this.sockets.handleUpgrade(request, socket, head, (ws) => this.joined_(ws));
    });
    await new Promise((resolve) => this.http.listen(port, '127.0.0.1', resolve));
    this.port = this.http.address().port;
    this.timer = setInterval(() => this.step(), 1000 / this.hz);
    return this.port;
  }

  async close() {
    clearInterval(this.timer);
    this.dropViewers();
    await new Promise((resolve) => this.http.close(resolve));
  }

  /** Terminates all connections without a close frame, like a network failure. */
  dropViewers() {
    for (const viewer of this.viewers) viewer.ws.terminate();
    this.viewers.clear();
  }

  async answer_(request, response) {
    const path = new URL(request.url, 'http://host').pathname;
    const json = (code, body) =>
      response.writeHead(code, { 'content-type': 'application/json' }).end(JSON.stringify(body));
    const summary = {
      id: 'demo',
      name: 'Demo',
      motions: this.motions,
      removed_volume_mm3: this.block.removedMm3,
      state_hash: this.hash_(),
      participants: this.participants_(),
    };
    if (path === '/v1/sessions') return json(200, { sessions: [summary] });
    if (path === '/v1/sessions/demo') return json(200, summary);
    if (path.startsWith('/v1/'))
      return json(404, {
        error: { code: 'unknown_session', reason: 'The session does not exist.' },
      });
    const file = normalize(path === '/' ? '/index.html' : path);
    try {
      const body = await readFile(join(this.root, file));
      response
        .writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' })
        .end(body);
    } catch {
      response.writeHead(404).end('not found');
    }
  }

  joined_(ws) {
    const viewer = {
      ws,
      id: 100 + this.viewers.size,
      inFlight: 0,
      lacking: new Set(this.block.versions.keys()),
      first: true,
      name: '',
    };
    ws.on('message', (data, binary) =>
      binary ? this.binary_(viewer, data) : this.text_(viewer, JSON.parse(data.toString())),
    );
    ws.on('close', () => {
      this.viewers.delete(viewer);
      this.sendParticipants_();
    });
  }

  text_(viewer, message) {
    if (message.type === 'look') this.lookMessages.push(message);
    if (message.type !== 'hello') return;
    if (Buffer.byteLength(message.name) > NAME_BYTES_MAX || message.name === this.refusedName) {
      const reason = `name must be at most ${NAME_BYTES_MAX} bytes`;
      viewer.ws.send(JSON.stringify({ type: 'error', code: 'too_large', reason, fatal: true }));
      return;
    }
    viewer.name = message.name;
    this.hellos.push(message.name);
    this.firstLooks.push(message.look);
    this.viewers.add(viewer);
    const half = this.block.sizeMm / 2;
    viewer.ws.send(
      JSON.stringify({
        type: 'welcome',
        session: 'demo',
        participant: viewer.id,
        epoch: 1,
        color: '#888888',
        pitch_mm: this.block.pitchMm,
        pivot_mm: 60,
        force: { law: 'specific_energy', specific_force_n_per_mm2: 0.5 },
        stock: {
          shape: 'box',
          min_mm: [-half, -half, -this.block.heightMm],
          max_mm: [half, half, 0],
        },
        tools: TOOLS,
        participants: this.participants_(),
        grid: {
          origin_mm: [-half, -half, -this.block.heightMm],
          columns: [this.block.columns, this.block.columns],
          tile: this.block.tile,
        },
      }),
    );
    this.sendParticipants_();
    this.sendMesh_(viewer);
  }

  binary_(viewer, data) {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const type = view.getUint8(4);
    if (type === 5) {
      this.acks.push(view.getBigUint64(16, true));
      viewer.inFlight -= 1;
      this.sendMesh_(viewer);
    } else if (type === 6) {
      const payload = new DataView(new ArrayBuffer(16));
      payload.setBigUint64(0, view.getBigUint64(32, true), true);
      payload.setBigUint64(8, this.nowUs_(), true);
      viewer.ws.send(this.frame_(7, 0, new Uint8Array(payload.buffer)));
    }
  }

  nowUs_() {
    return process.hrtime.bigint() / 1000n;
  }

  frame_(type, flags, payload) {
    const frame = new Uint8Array(32 + payload.length);
    const view = new DataView(frame.buffer);
    view.setUint32(0, 0x3146524b, true);
    view.setUint8(4, type);
    view.setUint8(5, flags);
    view.setUint16(6, 32, true);
    view.setUint32(8, payload.length, true);
    view.setUint32(12, 1, true);
    view.setBigUint64(16, BigInt(++this.sequence[type]), true);
    view.setBigUint64(24, this.nowUs_(), true);
    frame.set(payload, 32);
    return frame;
  }

  participants_() {
    const viewers = [...this.viewers].map(({ id, name }) => ({
      participant: id,
      name,
      color: '#888888',
      kind: 'viewer',
    }));
    return [
      ...this.agents.map(({ participant, name, color, tool, kind }) => ({
        participant,
        name,
        color,
        tool,
        kind,
      })),
      ...viewers,
    ];
  }

  sendParticipants_() {
    const text = JSON.stringify({ type: 'participants', participants: this.participants_() });
    for (const { ws } of this.viewers) ws.send(text);
  }

  hash_() {
    return this.motions.toString(16).padStart(16, '0');
  }

  sendMesh_(viewer) {
    while (viewer.inFlight < 2 && viewer.lacking.size > 0) {
      const keys = [...viewer.lacking].slice(0, 24);
      for (const key of keys) viewer.lacking.delete(key);
      const glb = writeMeshGlb(
        keys.map((key) => this.block.mesh(key)),
        STEP_MM,
        0,
        this.motions,
      );
      const flags = viewer.first ? 1 | (viewer.lacking.size === 0 ? 2 : 0) : 0;
      if (viewer.lacking.size === 0) viewer.first = false;
      viewer.inFlight += 1;
      viewer.ws.send(this.frame_(3, flags, glb));
    }
  }

  /** Advances every agent by one frame time, in several small cuts, and updates the viewers. */
  step() {
    const dirty = new Set();
    const states = this.agents.map((agent) => this.moveAgent_(agent, dirty));
    this.time += 1 / this.hz;
    for (const key of dirty) this.block.versions.set(key, this.block.versions.get(key) + 1);
    const tools = this.toolsPayload_(states);
    const settled = [...this.viewers].every((viewer) => viewer.lacking.size === 0);
    const state = JSON.stringify({
      type: 'state',
      motions: this.motions,
      removed_volume_mm3: this.block.removedMm3,
      state_hash: this.hash_(),
      settled,
    });
    for (const viewer of this.viewers) {
      for (const key of dirty) viewer.lacking.add(key);
      viewer.ws.send(this.frame_(4, 0, tools));
      viewer.ws.send(state);
      this.sendMesh_(viewer);
    }
  }

  moveAgent_(agent, dirty) {
    const cuts = 8;
    let removed = 0;
    let pose;
    for (let i = 0; i < cuts; ++i) {
      pose = this.pose_(agent, this.time + i / cuts / this.hz);
      removed += this.block.cut(pose.tip, agent.radius, dirty);
      this.motions += 1;
    }
    const rate = removed * this.hz;
    const ahead = this.pose_(agent, this.time + 1e-3);
    const travel = ahead.tip.map((v, k) => v - pose.tip[k]);
    const speed = Math.hypot(...travel) || 1;
    const force = travel.map((v) => (-v / speed) * rate * 0.02);
    force[2] += rate * 0.012;
    const arm = pose.axis.map((v) => -60 * v);
    const torque = [
      arm[1] * force[2] - arm[2] * force[1],
      arm[2] * force[0] - arm[0] * force[2],
      arm[0] * force[1] - arm[1] * force[0],
    ];
    return { agent, ...pose, force, torque, rate };
  }

  /** A rose curve that descends slowly, with a tilting tool. */
  pose_(agent, t) {
    const turn = t * 0.42 + agent.phase;
    const r = agent.reach * Math.abs(Math.cos((agent.petals * turn) / 2)) ** 0.8 + 3;
    const lean = 0.45 * Math.sin(turn * 2);
    const depth = 1 + Math.min(14, 0.12 * t) + 4 * (0.5 + 0.5 * Math.cos(agent.petals * turn));
    const axis = [lean * Math.cos(turn), lean * Math.sin(turn), 1];
    const length = Math.hypot(...axis);
    return {
      tip: [r * Math.cos(turn), r * Math.sin(turn), -depth],
      axis: axis.map((v) => v / length),
    };
  }

  toolsPayload_(states) {
    const view = new DataView(new ArrayBuffer(8 + 80 * states.length));
    view.setUint32(0, states.length, true);
    states.forEach(({ agent, tip, axis, force, torque, rate }, n) => {
      const at = 8 + 80 * n;
      view.setUint32(at, agent.participant, true);
      view.setUint32(at + 4, agent.tool, true);
      tip.forEach((v, k) => view.setFloat64(at + 8 + 8 * k, v, true));
      axis.forEach((v, k) => view.setFloat32(at + 32 + 4 * k, v, true));
      view.setUint32(at + 44, rate > 0 ? 1 : 0, true);
      force.forEach((v, k) => view.setFloat32(at + 48 + 4 * k, v, true));
      torque.forEach((v, k) => view.setFloat32(at + 60 + 4 * k, v, true));
      view.setFloat32(at + 72, rate, true);
    });
    return new Uint8Array(view.buffer);
  }
}
