// SPDX-License-Identifier: Apache-2.0
// The source of a new block: a template, a model or a program. A draft has its own part of the form
// and gives the scene.

import { t } from '../../strings';
import { describeProgram, uploadMesh } from '../../link/lobby_requests';
import type { NamedProgram, Template } from '../../link/lobby_requests';
import { lacksUnit, meshScene, stockBox, targetOf, withStock } from '../../model/new_block';
import type { Scene } from '../../model/new_block';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { resized, sizesOf } from '../../model/stock_size';
import { unplaced } from '../../model/placement';
import type { ToolInfo } from '../../wire/types';
import { h } from '../dom';
import { sentence } from '../format';
import { ToolRack } from '../tools/tool_rack';
import { uploadName } from '../programs/requests';
import { duration } from '../programs/texts';
import { placementForm } from './placement_form';
import { sizeRow } from './size_row';
import { boxTable, toolTable } from './tool_table';

export interface Draft {
  name: string;
  /** The accuracy to begin with; null: the usual one. */
  targetMm: number | null;
  element: HTMLElement;
  scene: () => Scene;
  /** To be started in the new session. */
  program: File | null;
  /** Its text; the price is then that of its motions instead of a hand's. */
  priced: NamedProgram | null;
}

export const MESH_ENDINGS = ['.stl', '.ply', '.obj', '.3mf', '.glb'];

function endsIn(name: string, endings: readonly string[]): boolean {
  return endings.some((ending) => name.toLowerCase().endsWith(ending));
}

function nameOf(file: File): string {
  return file.name.replace(/\.[^.]*$/, '');
}

/** A scene whose tools can be edited; `head`: what else its part of the form has. */
function withTools(scene: () => Scene, changed: () => void, head: HTMLElement) {
  const rack = new ToolRack((scene()['tools'] ?? []) as ToolInfo[], changed);
  return {
    element: h('div', { class: 'draft-tools' }, head, rack.element),
    scene: (): Scene => ({ ...scene(), tools: rack.tools }),
  };
}

export function fromTemplate({ title, scene }: Template, changed: () => void): Draft {
  const { name, stock } = scene;
  const sizes = sizesOf(stock);
  return {
    name: typeof name === 'string' ? name : title,
    targetMm: targetOf(scene),
    ...withTools(
      () => ({ ...scene, stock: resized(stock, sizes) }),
      changed,
      sizes.length > 0 ? sizeRow(sizes, changed) : h('div'),
    ),
    program: null,
    priced: null,
  };
}

async function fromMesh(file: File, changed: () => void, repair: boolean): Promise<Draft> {
  const mesh = await uploadMesh(file, repair);
  const placement = unplaced();
  const element = h('div', {}, placementForm(mesh, placement, lacksUnit(file.name), changed));
  if (mesh.repaired !== '') element.append(h('p', {}, sentence(t('Repaired: {0}', mesh.repaired))));
  return {
    name: nameOf(file),
    targetMm: null,
    ...withTools(() => meshScene(mesh.file, repair, placement), changed, element),
    program: null,
    priced: null,
  };
}

async function fromProgram(file: File, changed: () => void): Promise<Draft> {
  const priced = { name: uploadName(file.name), text: await file.text() };
  const derived = await describeProgram(priced);
  const { scene, provenance } = derived;
  const box = stockBox(scene);
  const tools = scene['tools'] as ToolInfo[];
  const size = t(
    '{0} at feed rate, about {1} on a machine',
    duration(derived.programmedS),
    duration(derived.machineS),
  );
  return {
    name: nameOf(file),
    targetMm: targetOf(scene),
    element: h(
      'div',
      { class: 'draft-program' },
      h('p', { class: 'quiet' }, `${file.name}: ${size}.`),
      box ? boxTable(box, provenance, changed) : h('div'),
      toolTable(tools, provenance, changed),
    ),
    scene: () => (box ? withStock({ ...scene, tools }, box) : scene),
    program: file,
    priced,
  };
}

/**
 * Reads a file as model or program; `changed` is called when its part of the form is edited.
 * `repair` closes the holes of a model.
 */
export function fromFile(file: File, changed: () => void, repair: boolean): Promise<Draft> {
  if (endsIn(file.name, MESH_ENDINGS)) return fromMesh(file, changed, repair);
  if (endsIn(file.name, PROGRAM_ENDINGS)) return fromProgram(file, changed);
  const known = [...MESH_ENDINGS, ...PROGRAM_ENDINGS].join(', ');
  return Promise.reject(
    new Error(t("{0} can't be read. Choose a file whose name ends in {1}", file.name, known)),
  );
}
