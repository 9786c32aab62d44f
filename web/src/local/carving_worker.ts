// SPDX-License-Identifier: Apache-2.0
// The worker that carves. Each block has one of its own: ending it ends whatever it does.

import { moduleBeside } from '../kernel/module';
import { t } from '../strings';
import type { FromWorker, ToWorker } from './messages';

/** Whether kerf_files.wasm was there when the page was built, or was to come later (vite.config.ts). */
declare const KERF_HAS_FILES: boolean;
export const HAS_FILES = KERF_HAS_FILES;

async function compiled(): Promise<WebAssembly.Module> {
  if (!HAS_FILES) throw new Error(t('this page was built without kerf_files.wasm'));
  const module = await moduleBeside('kerf_files.wasm');
  if (module) return module;
  throw new Error(t('kerf_files.wasm is not there yet: reload the page in a minute'));
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
