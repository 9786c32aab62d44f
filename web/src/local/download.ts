// SPDX-License-Identifier: Apache-2.0
// Saves models among the user's downloads.

import { saveFile } from '../ui/save_file';
import type { TakeHomeFormat } from './program_block';

const TYPE = 'application/octet-stream';

export function download(name: string, content: Uint8Array<ArrayBuffer> | Blob): void {
  saveFile(name, new Blob([content], { type: TYPE }));
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
