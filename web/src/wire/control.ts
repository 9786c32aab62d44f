// SPDX-License-Identifier: Apache-2.0
// Parses and validates JSON control messages from the server. Fields that the viewer uses must be
// present and finite. Unknown fields are kept and unknown types skipped, so that older viewers work
// with newer servers.

import { colorOf, InvalidField, list, number, numbers, object, text } from './json_fields';
import type { Json } from './json_fields';
import type { Reach } from './reach';
import type {
  Decoded,
  ParticipantInfo,
  PastPlace,
  Pin,
  ProgramInfo,
  ProgramState,
  ServerMessage,
  ShownCamera,
  Stock,
  ToolInfo,
  Vec3,
  Welcome,
} from './types';

function participantOf(value: unknown): ParticipantInfo {
  const from = object(value, 'participant');
  const kind = from['kind'];
  return {
    participant: number(from, 'participant'),
    name: text(from, 'name'),
    color: colorOf(from['color']),
    kind: kind === 'program' || kind === 'viewer' ? kind : 'agent',
    ...(typeof from['tool'] === 'number' ? { tool: from['tool'] } : {}),
    ...roleOf(from),
    ...(from['muted'] === true ? { muted: true } : {}),
    ...(from['reach'] === undefined ? {} : { reach: reachOf(from['reach']) }),
  };
}

function reachOf(value: unknown): Reach {
  const from = object(value, 'reach');
  return {
    center_mm: numbers(from, 'center_mm', 3) as Vec3,
    half_mm: numbers(from, 'half_mm', 3) as Vec3,
    turn_rad: numbers(from, 'turn_rad', 3) as Vec3,
    scale: number(from, 'scale'),
  };
}

function participantsOf(value: unknown): ParticipantInfo[] {
  return list(value, 'participants').map(participantOf);
}

/** Servers without rights send no role. */
function roleOf(from: Json): { role?: string } {
  return from['role'] === undefined ? {} : { role: text(from, 'role') };
}

/** The scene's name; servers of earlier versions do not send it. */
function nameOf(from: Json): { name?: string } {
  return typeof from['name'] === 'string' && from['name'] !== '' ? { name: from['name'] } : {};
}

function mayOf(from: Json): { may?: string[] } {
  if (from['may'] === undefined) return {};
  return { may: list(from['may'], 'may').filter((name) => typeof name === 'string') };
}

/** Spindle and teeth of the scene's force law, if it has them. */
function forceOf(from: Json): { force?: { spindle_rpm?: number; teeth?: number } } {
  if (from['force'] === undefined) return {};
  const force = object(from['force'], 'force');
  const of = (name: 'spindle_rpm' | 'teeth') =>
    force[name] === undefined ? {} : { [name]: number(force, name) };
  return { force: { ...of('spindle_rpm'), ...of('teeth') } };
}

/** The number of viewers, which servers of earlier versions do not send. */
function viewersOf(from: Json): { viewers?: number } {
  return from['viewers'] === undefined ? {} : { viewers: number(from, 'viewers') };
}

function pauseOf(word: unknown): { paused?: 'disk' | 'lease' } {
  if (typeof word !== 'string' || word === '') return {};
  return { paused: word === 'lease' ? 'lease' : 'disk' };
}

/** Where a viewer is that looks at the past. */
function placeOf(from: Json): { at?: PastPlace } {
  if (from['at'] === undefined) return {};
  const at = object(from['at'], 'at');
  return {
    at: {
      record: number(at, 'record'),
      time_ms: number(at, 'time_ms'),
      rate: number(at, 'rate'),
    },
  };
}

function idsOf(value: unknown): number[] {
  const ids = list(value, 'left');
  if (!ids.every((id) => typeof id === 'number')) throw new InvalidField('left must be numbers');
  return ids;
}

function stockOf(value: unknown): Stock {
  const from = object(value, 'stock');
  if (from['shape'] === 'box') {
    return {
      shape: 'box',
      min_mm: numbers(from, 'min_mm', 3) as Vec3,
      max_mm: numbers(from, 'max_mm', 3) as Vec3,
    };
  }
  if (from['shape'] === 'cylinder') {
    return {
      shape: 'cylinder',
      center_mm: numbers(from, 'center_mm', 2) as [number, number],
      radius_mm: number(from, 'radius_mm'),
      min_z_mm: number(from, 'min_z_mm'),
      max_z_mm: number(from, 'max_z_mm'),
    };
  }
  throw new InvalidField(`stock.shape ${JSON.stringify(from['shape'])} is not supported`);
}

/** A tool of a welcome, or of an answer over HTTP. */
export function toolOf(value: unknown): ToolInfo {
  const from = object(value, 'tool');
  return { ...(from as unknown as ToolInfo), id: number(from, 'id'), shape: text(from, 'shape') };
}

function welcomeOf(from: Json): Welcome {
  const grid = object(from['grid'], 'grid');
  return {
    type: 'welcome',
    session: text(from, 'session'),
    ...nameOf(from),
    participant: number(from, 'participant'),
    epoch: number(from, 'epoch'),
    color: colorOf(from['color']),
    pitch_mm: number(from, 'pitch_mm'),
    pivot_mm: number(from, 'pivot_mm'),
    stock: stockOf(from['stock']),
    tools: list(from['tools'], 'tools').map(toolOf),
    participants: participantsOf(from['participants']),
    ...viewersOf(from),
    ...roleOf(from),
    ...mayOf(from),
    ...forceOf(from),
    ...(from['budget'] === undefined ? {} : { budget: number(from, 'budget') }),
    ...(from['meshes'] === undefined ? {} : { meshes: number(from, 'meshes') }),
    ...(Array.isArray(from['others']) ? { others: from['others'].map(String) } : {}),
    grid: {
      origin_mm: numbers(grid, 'origin_mm', 3) as Vec3,
      columns: numbers(grid, 'columns', 2) as [number, number],
      tile: number(grid, 'tile'),
    },
  };
}

const PROGRAM_STATES: readonly string[] = [
  'queued',
  'running',
  'paused',
  'finished',
  'cancelled',
  'failed',
];

/** A program of a `programs` message, or its status over HTTP. */
export function programOf(value: unknown): ProgramInfo {
  const from = object(value, 'program');
  const state = text(from, 'state');
  return {
    id: number(from, 'id'),
    participant: number(from, 'participant'),
    name: text(from, 'name'),
    pace: from['pace'] === 'feed' ? 'feed' : 'fast',
    ...(from['speed'] === undefined ? {} : { speed: number(from, 'speed') }),
    state: PROGRAM_STATES.includes(state) ? (state as ProgramState) : 'unknown',
    ...(from['after'] === undefined ? {} : { after: number(from, 'after') }),
    waiting: from['waiting'] === true,
    motions_done: number(from, 'motions_done'),
    motions: number(from, 'motions'),
    line: number(from, 'line'),
    tool: number(from, 'tool'),
    feed_mm_per_min: number(from, 'feed_mm_per_min'),
    programmed_s: number(from, 'programmed_s'),
    elapsed_s: number(from, 'elapsed_s'),
    remaining_s: number(from, 'remaining_s'),
    removed_volume_mm3: number(from, 'removed_volume_mm3'),
    alarm_count: number(from, 'alarm_count'),
    ...(from['error'] === undefined ? {} : { error: text(from, 'error') }),
  };
}

/** A pin of a `pins` message. */
function pinOf(value: unknown): Pin {
  const from = object(value, 'pin');
  return {
    pin: number(from, 'pin'),
    text: text(from, 'text'),
    at_mm: numbers(from, 'at_mm', 3) as Vec3,
    normal: numbers(from, 'normal', 3) as Vec3,
    author: text(from, 'author'),
    created_ms: number(from, 'created_ms'),
  };
}

function cameraOf(value: unknown): ShownCamera {
  const from = object(value, 'camera');
  return {
    participant: number(from, 'participant'),
    name: text(from, 'name'),
    color: colorOf(from['color']),
    eye_mm: numbers(from, 'eye_mm', 3) as Vec3,
    target_mm: numbers(from, 'target_mm', 3) as Vec3,
    parallel: from['parallel'] === true,
  };
}

function messageOf(from: Json): ServerMessage | null {
  switch (from['type']) {
    case 'welcome':
      return welcomeOf(from);
    case 'participants':
      return {
        type: 'participants',
        participants: participantsOf(from['participants']),
        ...viewersOf(from),
      };
    case 'participants_changed':
      return {
        type: 'participants_changed',
        changed: participantsOf(from['changed'] ?? []),
        left: idsOf(from['left'] ?? []),
        viewers: number(from, 'viewers'),
      };
    case 'state':
      return {
        type: 'state',
        motions: number(from, 'motions'),
        removed_volume_mm3: number(from, 'removed_volume_mm3'),
        state_hash: text(from, 'state_hash'),
        settled: from['settled'] === true,
        ...pauseOf(from['paused']),
        ...placeOf(from),
      };
    case 'programs':
      return { type: 'programs', programs: list(from['programs'], 'programs').map(programOf) };
    case 'tools':
      return { type: 'tools', tools: list(from['tools'], 'tools').map(toolOf) };
    case 'name':
      return { type: 'name', name: text(from, 'name') };
    case 'pins':
      return { type: 'pins', pins: list(from['pins'], 'pins').map(pinOf) };
    case 'cameras':
      return { type: 'cameras', cameras: list(from['cameras'], 'cameras').map(cameraOf) };
    case 'error':
      return {
        type: 'error',
        code: text(from, 'code'),
        reason: text(from, 'reason'),
        fatal: from['fatal'] === true,
      };
    case 'bye':
      return {
        type: 'bye',
        reason: text(from, 'reason'),
        ...(typeof from['redirect'] === 'string' ? { redirect: from['redirect'] } : {}),
      };
    default:
      return null;
  }
}

/** Parses one text frame; the value is null for message types unknown to this version. */
export function parseControl(frame: string): Decoded<ServerMessage | null> {
  try {
    return { ok: true, value: messageOf(object(JSON.parse(frame), 'message')) };
  } catch (problem) {
    return {
      ok: false,
      error: { code: 'bad_json', offset: 0, reason: (problem as Error).message },
    };
  }
}
