// SPDX-License-Identifier: Apache-2.0
// The source of a new block: a template, a model or a program. A draft has its own part of the form
// and gives the scene.

import { signal } from '@preact/signals';
import type { VNode } from 'preact';
import { t } from '../../strings';
import { describeProgram, uploadMesh } from '../../link/lobby_requests';
import type { NamedProgram, Template } from '../../link/lobby_requests';
import { lacksUnit, meshScene, stockBox, targetOf, withStock } from '../../model/new_block';
import type { Scene } from '../../model/new_block';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { resized, sizesOf } from '../../model/stock_size';
import type { Box } from '../../model/box';
import { unplaced } from '../../model/placement';
import type { ToolInfo } from '../../wire/types';
import { sentence } from '../format';
import { ToolRack, ToolRackView } from '../tools/tool_rack';
import { uploadName } from '../programs/requests';
import { duration } from '../programs/texts';
import { PlacementForm } from './placement_form';
import { SizeRow } from './size_row';
import { BoxTable, ToolTable } from './tool_table';

export interface Draft {
  name: string;
  /** The accuracy to begin with; null: the usual one. */
  targetMm: number | null;
  /** Its own part of the form. */
  form: VNode;
  /** Returns the scene, which is tracked as signals are. */
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

/** A scene whose tools can be edited; `head` is the rest of its part of the form. */
function withTools(scene: () => Scene, head: VNode): Pick<Draft, 'form' | 'scene'> {
  const rack = new ToolRack((scene()['tools'] ?? []) as ToolInfo[]);
  return {
    form: (
      <div class="draft-tools">
        {head}
        <ToolRackView rack={rack} />
      </div>
    ),
    scene: () => ({ ...scene(), tools: rack.tools }),
  };
}

export function fromTemplate({ title, scene }: Template): Draft {
  const { name, stock } = scene;
  const sizes = signal<readonly number[]>(sizesOf(stock));
  return {
    name: typeof name === 'string' ? name : title,
    targetMm: targetOf(scene),
    ...withTools(
      () => ({ ...scene, stock: resized(stock, sizes.value) }),
      sizes.peek().length > 0 ? <SizeRow sizes={sizes} /> : <div />,
    ),
    program: null,
    priced: null,
  };
}

async function fromMesh(file: File, repair: boolean): Promise<Draft> {
  const mesh = await uploadMesh(file, repair);
  const placement = signal(unplaced());
  const head = (
    <div>
      <PlacementForm mesh={mesh} placement={placement} asksUnit={lacksUnit(file.name)} />
      {mesh.repaired !== '' && <p>{sentence(t('Repaired: {0}', mesh.repaired))}</p>}
    </div>
  );
  return {
    name: nameOf(file),
    targetMm: null,
    ...withTools(() => meshScene(mesh.file, repair, placement.value), head),
    program: null,
    priced: null,
  };
}

async function fromProgram(file: File): Promise<Draft> {
  const priced = { name: uploadName(file.name), text: await file.text() };
  const derived = await describeProgram(priced);
  const { scene, provenance } = derived;
  const stock = stockBox(scene);
  const box = stock && signal<Box>(stock);
  const tools = signal(scene['tools'] as readonly ToolInfo[]);
  const size = t(
    '{0} at feed rate, about {1} on a machine',
    duration(derived.programmedS),
    duration(derived.machineS),
  );
  const withToolsOf = (): Scene => ({ ...scene, tools: tools.value });
  return {
    name: nameOf(file),
    targetMm: targetOf(scene),
    form: (
      <div class="draft-program">
        <p class="quiet">{`${file.name}: ${size}.`}</p>
        {box ? <BoxTable box={box} origins={provenance} /> : <div />}
        <ToolTable tools={tools} origins={provenance} />
      </div>
    ),
    scene: () => (box ? withStock(withToolsOf(), box.value) : withToolsOf()),
    program: file,
    priced,
  };
}

/** Reads a file as model or program. `repair` closes the holes of a model. */
export function fromFile(file: File, repair: boolean): Promise<Draft> {
  if (endsIn(file.name, MESH_ENDINGS)) return fromMesh(file, repair);
  if (endsIn(file.name, PROGRAM_ENDINGS)) return fromProgram(file);
  const known = [...MESH_ENDINGS, ...PROGRAM_ENDINGS].join(', ');
  return Promise.reject(
    new Error(t("{0} can't be read. Choose a file whose name ends in {1}", file.name, known)),
  );
}
