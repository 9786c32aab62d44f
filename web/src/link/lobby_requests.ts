// SPDX-License-Identifier: Apache-2.0
// HTTP requests of the list of sessions and of new blocks. All reject with a ServerError.

import type { DerivedScene, FieldOrigin, Price, Scene } from '../model/new_block';
import type { Box } from '../model/box';
import type { Vec3 } from '../wire/types';
import { ask } from './server_error';

type Json = Record<string, unknown>;

export interface Template {
  id: string;
  title: string;
  description: string;
  scene: Scene;
}

export interface Person {
  name: string;
  color: string;
  kind: string;
}

/** The details of a card that the list lacks. */
export interface SessionDetails {
  people: Person[];
  stock: unknown;
  pitchMm: number;
}

export interface UploadedMesh {
  file: string;
  triangles: number;
  box: Box;
  /** The repairs of the mesh; '' if there are none. */
  repaired: string;
  /** Its numbers, taken as mm, make an unlikely size. */
  isUnlikely: boolean;
}

function listOf(value: unknown): Json[] {
  return Array.isArray(value) ? (value as Json[]) : [];
}

function boxOf(from: Json): Box {
  return { min: from['min_mm'] as Vec3, max: from['max_mm'] as Vec3 };
}

function sessionPath(id: string): string {
  return `/v1/sessions/${encodeURIComponent(id)}`;
}

export async function listTemplates(): Promise<Template[]> {
  const body = (await (await ask('GET', '/v1/templates')).json()) as Json;
  return listOf(body['templates']).map((from) => ({
    id: String(from['id']),
    title: String(from['title']),
    description: String(from['description']),
    scene: from['scene'] as Scene,
  }));
}

export async function sessionDetails(id: string): Promise<SessionDetails> {
  const body = (await (await ask('GET', sessionPath(id))).json()) as Json;
  return {
    people: listOf(body['participants']).map((from) => ({
      name: String(from['name']),
      color: String(from['color']),
      kind: String(from['kind']),
    })),
    stock: body['stock'],
    pitchMm: Number(body['pitch_mm']),
  };
}

/** A program that is to be carved; `name` as uploadName gives it. */
export interface NamedProgram {
  name: string;
  text: string;
}

/** The cost of a scene, or of a program in it. Rejects with the reason why it cannot be made. */
export async function priceOf(
  scene: Scene,
  program: NamedProgram | null = null,
  signal: AbortSignal | null = null,
): Promise<Price> {
  const response = program
    ? await ask(
        'POST',
        `/v1/prices?name=${encodeURIComponent(program.name)}`,
        JSON.stringify({ scene, program: program.text }),
        signal,
      )
    : await ask('POST', '/v1/sessions?dry_run=1', JSON.stringify(scene), signal);
  const body = (await response.json()) as Json;
  return {
    bytes: Number(body['bytes']),
    usPerMotion: Number(body['us_per_motion']),
    joinS: Number(body['join_s']),
    ...(program ? { motions: Number(body['motions']) } : {}),
  };
}

export async function createSession(id: string, scene: Scene): Promise<void> {
  await ask('POST', `/v1/sessions?id=${encodeURIComponent(id)}`, JSON.stringify(scene));
}

/** Gives a session a name that no other one has. */
export async function renameSession(id: string, name: string): Promise<void> {
  await ask('PATCH', `${sessionPath(id)}?name=${encodeURIComponent(name)}`);
}

/** Makes a session with the same block and history under another name. Returns its id. */
export async function duplicateSession(id: string, name: string): Promise<string> {
  const query = `from=${encodeURIComponent(id)}&name=${encodeURIComponent(name)}`;
  const made = (await (await ask('POST', `/v1/sessions?${query}`)).json()) as Json;
  return String(made['id']);
}

/** Closes a session. Its journal stays on the server, unless `forever`. */
export async function closeSession(id: string, forever = false): Promise<void> {
  await ask('DELETE', sessionPath(id) + (forever ? '?purge=1' : ''));
}

/** Stores a mesh; `repair` closes its holes and orients its triangles, as a scene's does. */
export async function uploadMesh(file: File, repair: boolean): Promise<UploadedMesh> {
  const query = `name=${encodeURIComponent(file.name)}${repair ? '&repair=1' : ''}`;
  const body = (await (await ask('POST', `/v1/files?${query}`, file)).json()) as Json;
  return {
    file: String(body['file']),
    triangles: Number(body['triangles']),
    box: boxOf(body),
    repaired: typeof body['repaired'] === 'string' ? body['repaired'] : '',
    isUnlikely: listOf(body['questions']).length > 0,
  };
}

/** The scene for a program. */
export async function describeProgram({ name, text }: NamedProgram): Promise<DerivedScene> {
  const response = await ask('POST', `/v1/programs?name=${encodeURIComponent(name)}`, text);
  const body = (await response.json()) as Json;
  return {
    scene: body['scene'] as Scene,
    provenance: listOf(body['provenance']) as unknown as FieldOrigin[],
    motions: Number(body['motions']),
    programmedS: Number(body['programmed_s']),
    machineS: Number(body['machine_s']),
  };
}
