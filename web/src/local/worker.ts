// SPDX-License-Identifier: Apache-2.0
// The worker of the page without a server.

import { buffersOf } from '../kernel/kernel';
import { Carver } from './carver';
import type { FromWorker, ToWorker } from './messages';
import { ProgramBlock } from './program_block';

/** What need not be copied. */
function transferOf(message: FromWorker): Transferable[] {
  if (message.type === 'model') return [message.bytes.buffer];
  if (message.type === 'mesh') return buffersOf([message.tile]);
  return message.type === 'carved' ? buffersOf(message.tiles) : [];
}

// A timer would wait; the messages of a channel come after those that wait already.
const channel = new MessageChannel();
const waiting: (() => void)[] = [];
channel.port1.onmessage = () => waiting.shift()?.();

const carver = new Carver({
  post: (message) => self.postMessage(message, { transfer: transferOf(message) }),
  load: (module) => ProgramBlock.of(module),
  later: (act) => {
    waiting.push(act);
    channel.port2.postMessage(null);
  },
  nowMs: () => performance.now(),
});
onmessageerror = () => self.postMessage({ type: 'failed', reason: 'A message cannot be read.' });
let last = Promise.resolve();
onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if (data.type === 'load') last = carver.receive(data);
  else void last.then(() => carver.receive(data));
};
