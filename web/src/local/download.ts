// SPDX-License-Identifier: Apache-2.0
// Gives the user a file.

import { h } from '../ui/dom';
import type { TakeHomeFormat } from './program_block';

const TYPE = 'application/octet-stream';

export function download(name: string, content: Uint8Array<ArrayBuffer> | Blob): void {
  const url = URL.createObjectURL(new Blob([content], { type: TYPE }));
  h('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** Gives the user a model that the kernel for pages has written. */
export async function downloadModel(
  name: string,
  format: TakeHomeFormat,
  bytes: Uint8Array<ArrayBuffer>,
): Promise<void> {
  const file = `${name}.${format}`;
  if (format !== '3mf') {
    download(file, bytes);
    return;
  }
  const compressed = import('./compressed_zip').then((zip) => zip.compressedZip(bytes));
  download(file, await compressed.catch(() => bytes)); // larger, and right too
}
