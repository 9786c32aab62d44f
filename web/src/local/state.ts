// SPDX-License-Identifier: Apache-2.0
// The state of the page without a server: the files, how far the block is, and its figures.

import { batch, computed, signal } from '@preact/signals';
import { NO_FILES, withFiles } from './given_files';
import type { About, GivenFile, GivenFiles, Progress } from './program_block';

export type Status = 'empty' | 'reading' | 'carving' | 'rest' | 'failed';

export class LocalState {
  readonly files = signal<GivenFiles>(NO_FILES);
  readonly status = signal<Status>('empty');
  /** The block; null: none. */
  readonly about = signal<About | null>(null);
  readonly progress = signal<Progress | null>(null);
  /** Null until the block rests. */
  readonly hash = signal<string | null>(null);
  /** Time of carving alone, ms. */
  readonly carvingMs = signal(0);
  readonly triangles = signal(0);
  /** The position of the scrub bar; null: the end of the program. */
  readonly wish = signal<number | null>(null);
  /** How the state compares with the one that the journal stores; empty: it stores none. */
  readonly stored = signal('');
  /** Whether the block has a journal, which the page may save. */
  readonly hasJournal = signal(false);
  /** Why files are of no use, or a command was not performed; empty: no reason. */
  readonly error = signal('');
  /** The scene of the block with which the page opens, which is none of the user's files. */
  readonly starter = signal<GivenFile | null>(null);
  readonly isStarter = computed(() => {
    const { scene } = this.files.value;
    return scene !== null && scene === this.starter.value;
  });
  /** The text of the program; null: there is no program. */
  readonly text = computed(() => {
    const { program } = this.files.value;
    return program && new TextDecoder().decode(program.bytes);
  });
  readonly isBusy = computed(() => ['reading', 'carving'].includes(this.status.value));
  /** Whether the block can be saved. */
  readonly canSave = computed(() => this.status.value === 'rest' && this.about.value !== null);

  /** Adds the user's files to those that are there. The page's own block gives way to them. */
  give(files: readonly GivenFile[]): void {
    const before = this.isStarter.peek() ? NO_FILES : this.files.peek();
    this.files.value = withFiles(before, files);
  }

  /** Opens a block of the page in place of all files. */
  giveStarter(scene: GivenFile): void {
    batch(() => {
      this.starter.value = scene;
      this.files.value = { ...NO_FILES, scene };
    });
  }

  /** The files are read, and carved from the start. */
  begin(): void {
    const { program, scene, stock, journal } = this.files.peek();
    const isEmpty = (journal ?? program ?? scene ?? stock) === null;
    batch(() => {
      this.status.value = isEmpty ? 'empty' : 'reading';
      this.about.value = null;
      this.progress.value = null;
      this.hash.value = null;
      this.carvingMs.value = 0;
      this.triangles.value = 0;
      this.wish.value = null;
      this.stored.value = '';
      this.hasJournal.value = false;
      this.error.value = '';
    });
  }

  /** A hand has added records to those that were read. */
  extend(motions: number): void {
    const about = this.about.peek();
    if (about && motions > about.motions) this.about.value = { ...about, motions };
  }
}
