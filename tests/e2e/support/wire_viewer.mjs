// SPDX-License-Identifier: Apache-2.0
// A viewer without a browser: joins by the documented protocol and keeps the GLB of every mesh
// frame as received.

import WebSocket from 'ws';

const HEADER_BYTES = 32;
const MESH = 3;
const TOOLS = 4;
const ACK = 5;
const DROPPED = 1006; // without a word

export class WireViewer {
  constructor(baseUrl, session) {
    this.glbs = [];
    this.toolFrames = 0;
    this.snapshotComplete = false;
    this.errors = [];
    this.state = null;
    this.welcome = null;
    this.isClosed = false;
    this.join_(`${baseUrl.replace('http', 'ws')}/v1/sessions/${session}/view`);
  }

  /** Joins, and again as a page does when the server has dropped it: on a busy machine it reads late. */
  join_(url) {
    const socket = new WebSocket(url, 'kerf.view.v1');
    this.socket = socket;
    socket.on('open', () => socket.send(JSON.stringify({ type: 'hello', name: 'wire test' })));
    socket.on('message', (data, binary) =>
      binary ? this.frame_(data) : this.message_(JSON.parse(data.toString())),
    );
    socket.on('error', (problem) => this.errors.push(problem.message));
    socket.on('close', (code, reason) => {
      if (this.isClosed) return;
      if (code === DROPPED) this.join_(url);
      else this.errors.push(`closed with ${code}: ${reason}`);
    });
  }

  message_(message) {
    if (message.type === 'welcome') this.welcome = message;
    if (message.type === 'state') this.state = message;
    if (message.type === 'error') this.errors.push(`${message.code}: ${message.reason}`);
  }

  frame_(data) {
    const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    const type = view.getUint8(4);
    if (type === TOOLS) this.toolFrames += 1;
    if (type !== MESH) return;
    this.glbs.push(Buffer.from(data.subarray(view.getUint16(6, true))));
    if (view.getUint8(5) & 2) this.snapshotComplete = true;
    this.acknowledge_(view);
  }

  acknowledge_(of) {
    const frame = new DataView(new ArrayBuffer(HEADER_BYTES));
    frame.setUint32(0, 0x3146524b, true);
    frame.setUint8(4, ACK);
    frame.setUint16(6, HEADER_BYTES, true);
    frame.setUint32(12, of.getUint32(12, true), true);
    frame.setBigUint64(16, of.getBigUint64(16, true), true);
    this.socket.send(new Uint8Array(frame.buffer));
  }

  /**
   * Sends a camera position and an acceptable error; the server answers with tiles of other levels.
   */
  sendLook(eye_mm, error_rad) {
    this.socket.send(JSON.stringify({ type: 'look', eye_mm, error_rad }));
  }

  close() {
    this.isClosed = true;
    this.socket.close();
  }
}
