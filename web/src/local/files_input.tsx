// SPDX-License-Identifier: Apache-2.0
// Takes the user's files: chosen in the browser's dialog, or dropped on the page.

import type { Signal } from '@preact/signals';
import { createRef } from 'preact';
import type { VNode } from 'preact';
import { t } from '../strings';
import type { GivenFile } from './program_block';

async function read(files: readonly File[]): Promise<GivenFile[]> {
  const given = files.map(async (file) => ({
    name: file.name,
    bytes: new Uint8Array(await file.arrayBuffer()),
  }));
  return Promise.all(given);
}

export class FilesInput {
  private readonly input_ = createRef<HTMLInputElement>();

  constructor(private readonly take: (files: readonly GivenFile[]) => void) {}

  choose(): void {
    this.input_.current?.click();
  }

  view(): VNode {
    return (
      <input
        ref={this.input_}
        type="file"
        multiple
        hidden
        aria-label={t('Files')}
        onChange={({ currentTarget }) => {
          void this.read_([...(currentTarget.files ?? [])]);
          currentTarget.value = ''; // the same file may be chosen again
        }}
      />
    );
  }

  /** Files may be dropped here; `isDropping`: they are dragged over it. */
  takeDropsOn(main: HTMLElement, isDropping: Signal<boolean>): void {
    main.addEventListener('dragover', (event) => {
      event.preventDefault();
      isDropping.value = true;
    });
    for (const end of ['dragleave', 'drop'])
      main.addEventListener(end, () => (isDropping.value = false));
    main.addEventListener('drop', (event) => {
      event.preventDefault();
      void this.read_([...(event.dataTransfer?.files ?? [])]);
    });
  }

  private async read_(files: readonly File[]): Promise<void> {
    if (files.length > 0) this.take(await read(files));
  }
}
