// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { workerDecoder } from '../../src/decode/frame_decoder';
import type { Decoded } from '../../src/decode/decoded';
import type { DecoderPort } from '../../src/decode/frame_decoder';

class FakeWorker implements DecoderPort {
  static made: FakeWorker[] = [];
  onmessage: ((event: { data: Decoded }) => void) | null = null;
  onerror: ((event: { message?: string }) => void) | null = null;
  readonly frames: Uint8Array[] = [];
  constructor() {
    FakeWorker.made.push(this);
  }
  postMessage(glb: Uint8Array): void {
    this.frames.push(glb);
  }
  answer(data: Decoded): void {
    this.onmessage?.({ data });
  }
}

const frameOf = (motions: number): Decoded => ({ frame: { motions, nodes: [], shapes: [] } });

describe('the decoder of mesh frames', () => {
  it('answers in the order of the frames, with a reason for those that are broken', async () => {
    FakeWorker.made = [];
    const decode = workerDecoder(() => new FakeWorker());
    expect(FakeWorker.made).toHaveLength(0);
    const answers = [
      decode(new Uint8Array(1)),
      decode(new Uint8Array(2)),
      decode(new Uint8Array()),
    ];
    const [worker] = FakeWorker.made;
    worker!.answer(frameOf(1));
    worker!.answer({ reason: 'it is not a GLB' });
    worker!.answer(frameOf(3));
    expect((await answers[0]!).motions).toBe(1);
    await expect(answers[1]).rejects.toThrow('it is not a GLB');
    expect((await answers[2]!).motions).toBe(3);
    expect(FakeWorker.made).toHaveLength(1);
  });

  it('rejects all frames of a worker that ends, and begins another one', async () => {
    FakeWorker.made = [];
    const decode = workerDecoder(() => new FakeWorker());
    const lost = [decode(new Uint8Array(1)), decode(new Uint8Array(1))];
    FakeWorker.made[0]!.onerror?.({ message: 'gone' });
    for (const one of lost) await expect(one).rejects.toThrow('gone');
    const next = decode(new Uint8Array(1));
    FakeWorker.made[1]!.answer(frameOf(2));
    expect((await next).motions).toBe(2);
  });
});
