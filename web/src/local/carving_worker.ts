// SPDX-License-Identifier: Apache-2.0
// The worker that carves. Each block has one of its own: ending it ends whatever it does.

import { t } from '../strings';
import type { FromWorker, ToWorker } from './messages';

/** Whether kerf_files.wasm was there when the page was built (vite.config.ts). */
declare const KERF_HAS_FILES: boolean;
export const HAS_FILES = KERF_HAS_FILES;

/** The page compiles it, because the policy of a worker's file forbids that (server/http). */
async function compiled(): Promise<WebAssembly.Module> {
  if (!HAS_FILES) throw new Error(t('this page was built without kerf_files.wasm'));
  const url = new URL('kerf_files.wasm', document.baseURI);
  try {
    return await WebAssembly.compileStreaming(fetch(url));
  } catch {
    // A host of files may send it as another type.
    return await WebAssembly.compile(await (await fetch(url)).arrayBuffer());
  }
}

export class CarvingWorker {
  private worker_: Worker | null = null;
  private module_: Promise<WebAssembly.Module> | null = null;

  constructor(private readonly heard: (message: FromWorker) => void) {}

  /** Reads and carves files or a journal, in place of those before. */
  open(first: ToWorker & { type: 'open' | 'journal' }): void {
    this.end();
    const worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
    this.worker_ = worker;
    const fail = (reason: string): void => {
      if (this.worker_ === worker) this.heard({ type: 'failed', reason });
    };
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if (this.worker_ === worker) this.heard(data);
    };
    worker.onerror = ({ message }) => fail(message || 'its worker did not load');
    this.module_ ??= compiled();
    this.module_.then(
      (module) => {
        worker.postMessage({ type: 'load', module } satisfies ToWorker);
        worker.postMessage(first);
      },
      (problem: unknown) => {
        this.module_ = null; // the next block tries again
        fail((problem as Error).message);
      },
    );
  }

  post(message: ToWorker): void {
    this.worker_?.postMessage(message);
  }

  end(): void {
    this.worker_?.terminate();
    this.worker_ = null;
  }
}
