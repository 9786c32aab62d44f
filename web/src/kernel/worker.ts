// SPDX-License-Identifier: Apache-2.0
// The worker of the page's copy of the block.

import { CopyKeeper } from './copy_keeper';
import { buffersOf, Kernel } from './kernel';
import type { FromWorker, ToWorker } from './messages';

function post(message: FromWorker): void {
  postMessage(message, { transfer: message.type === 'tiles' ? buffersOf(message.tiles) : [] });
}

const keeper = new CopyKeeper(
  post,
  (module) => Kernel.of(module),
  (act) => setTimeout(act),
);
// Such as a module that this browser does not pass to workers.
onmessageerror = () => post({ type: 'failed', reason: 'A message cannot be read.' });
let last = Promise.resolve();
onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if (data.type === 'load') last = keeper.receive(data);
  else void last.then(() => keeper.receive(data));
};
