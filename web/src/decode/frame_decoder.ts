// SPDX-License-Identifier: Apache-2.0
// The page's side of the worker that decodes mesh frames.

import type { Decoded } from './decoded';
import type { MeshFrame } from './mesh_glb';

/** Rejects with a reason if a frame cannot be decoded. */
export type DecodeFrame = (glb: Uint8Array) => Promise<MeshFrame>;

/** The part of Worker that is used. */
export interface DecoderPort {
  onmessage: ((event: { data: Decoded }) => void) | null;
  /** Its code did not load, or ended in an error. */
  onerror: ((event: { message?: string }) => void) | null;
  postMessage(glb: Uint8Array): void;
}

function makeWorker(): DecoderPort {
  return new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' }) as DecoderPort;
}

interface Waiting {
  resolve: (frame: MeshFrame) => void;
  reject: (problem: Error) => void;
}

/** Decodes mesh frames in a worker, which starts with the first frame. */
export function workerDecoder(make: () => DecoderPort = makeWorker): DecodeFrame {
  let waiting: Waiting[] = [];
  let worker: DecoderPort | null = null;
  const begin = (): DecoderPort => {
    const begun = make();
    begun.onmessage = ({ data }) => {
      const { resolve, reject } = waiting.shift()!;
      if ('frame' in data) resolve(data.frame);
      else reject(new Error(data.reason));
    };
    begun.onerror = ({ message }) => {
      const problem = new Error(message ?? 'the worker that decodes tiles did not load');
      for (const { reject } of waiting) reject(problem);
      waiting = [];
      worker = null; // the next frame tries again
    };
    return begun;
  };
  return (glb) =>
    new Promise((resolve, reject) => {
      worker ??= begin();
      waiting.push({ resolve, reject });
      worker.postMessage(glb);
    });
}
