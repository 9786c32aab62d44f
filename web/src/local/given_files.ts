// SPDX-License-Identifier: Apache-2.0
// Which of the user's files is what: by their names, as kerf-carve judges them.

import type { GivenFile, GivenFiles } from './program_block';

export const NO_FILES: GivenFiles = {
  program: null,
  scene: null,
  stock: null,
  journal: null,
  others: [],
};

/** For the dialog of the browser; programs have many endings. */
export const MODEL = /\.(stl|ply|obj|3mf|glb)$/i;
const SCENE = /\.json$/i;
const JOURNAL = /\.kerf$/i;

/**
 * Adds files to those that are there. The first program takes the place of the one before, further
 * ones are its subroutines; a journal takes the place of all, and they of a journal; a scene takes the place of a scene. A model is the stock, and a file
 * that the scene may name where there is one.
 */
export function withFiles(before: GivenFiles, added: readonly GivenFile[]): GivenFiles {
  const journal = added.filter(({ name }) => JOURNAL.test(name)).at(-1);
  if (journal) return { ...NO_FILES, journal };
  const files = { ...before, journal: null };
  let hasProgram = false;
  for (const file of added) {
    if (SCENE.test(file.name)) files.scene = file;
    else if (MODEL.test(file.name)) files.stock = file;
    else if (!hasProgram) {
      files.program = file;
      files.others = [];
      hasProgram = true;
    } else files.others = [...files.others, file];
  }
  return files;
}

/** As they are read: a scene names its stock itself. */
export function asRead(files: GivenFiles): GivenFiles {
  const { scene, stock, others } = files;
  if (!scene || !stock) return files;
  return { ...files, stock: null, others: [...others, stock] };
}

/** Where an error is: "part.ngc:12: 'P12' must …"; null: in no line of this file. */
export function placeOfError(name: string, reason: string): { line: number; word: string } | null {
  if (!reason.startsWith(`${name}:`)) return null;
  const found = /^(\d+): (?:'(.*?)' )?/.exec(reason.slice(name.length + 1));
  return found ? { line: Number(found[1]), word: found[2] ?? '' } : null;
}
