// SPDX-License-Identifier: Apache-2.0
// Takes the user's files: chosen in the browser's dialog, or dropped on the page.

import { t } from '../strings';
import { h } from '../ui/dom';
import type { GivenFile } from './program_block';

async function read(files: readonly File[]): Promise<GivenFile[]> {
  const given = files.map(async (file) => ({
    name: file.name,
    bytes: new Uint8Array(await file.arrayBuffer()),
  }));
  return Promise.all(given);
}

export class FilesInput {
  readonly element = h('input', {
    type: 'file',
    multiple: '',
    hidden: '',
    'aria-label': t('Files'),
  });

  constructor(private readonly take: (files: readonly GivenFile[]) => void) {
    this.element.addEventListener('change', () => {
      void this.read_([...(this.element.files ?? [])]);
      this.element.value = ''; // the same file may be chosen again
    });
  }

  choose(): void {
    this.element.click();
  }

  /** Files may be dropped here. */
  takeDropsOn(main: HTMLElement): void {
    main.addEventListener('dragover', (event) => {
      event.preventDefault();
      main.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop'])
      main.addEventListener(end, () => main.classList.remove('dropping'));
    main.addEventListener('drop', (event) => {
      event.preventDefault();
      void this.read_([...(event.dataTransfer?.files ?? [])]);
    });
  }

  private async read_(files: readonly File[]): Promise<void> {
    if (files.length > 0) this.take(await read(files));
  }
}
