// SPDX-License-Identifier: Apache-2.0
// HTTP requests about the programs of a session.

import { forceCurve } from '../../link/history';
import type { ForceCurve } from '../../model/force_curve';
import { ask } from '../../link/server_error';
import { listStrokes } from '../../link/strokes';
import { pathOfAnswer } from '../../model/program_path';
import type { ProgramPath } from '../../model/program_path';
import { programOf } from '../../wire/control';
import { nameThatFits } from '../../wire/names';
import type { ProgramInfo, Vec3 } from '../../wire/types';

/** As many as the server gives. */
const PATH_POINTS = 20_000;
const CUT_POINTS = 600;

/** Consecutive motions with something that should not happen. */
export interface Alarm {
  kind: string;
  fromLine: number;
  toLine: number;
  tool: number;
  amount: number;
  /** That the amount of a motion exceeded. */
  limit: number;
  unit: string;
  /** The tip at its worst; of a gouge the deepest place. */
  place: Vec3;
}

export interface ProgramDetails {
  program: ProgramInfo;
  tools: number[];
  /** Language of the program, and why it: "Haas: line 3 has G154". */
  readAs: string;
  /** The part that is watched for gouges; empty: none. */
  target: string;
  targetToleranceMm: number;
  warnings: string[];
  alarms: Alarm[];
  /** Whether this person may pause, step, pace and cancel it: its own ones, or any as an owner. */
  mayControl: boolean;
}

/**
 * Whether `program`, as it was pushed, has details newer than those: it has other alarms, or it has
 * moved or ended since, by which its last alarms may have grown.
 */
export function isOutdated(details: ProgramDetails | undefined, program: ProgramInfo): boolean {
  if (details?.program.alarm_count !== program.alarm_count) return true;
  const { motions_done, state } = details.program;
  const hasChanged = motions_done !== program.motions_done || state !== program.state;
  return program.alarm_count > 0 && hasChanged;
}

type Json = Record<string, unknown>;

function listOf(value: unknown): unknown[] {
  return Array.isArray(value) ? value : [];
}

function alarmOf(value: unknown): Alarm {
  const from = value as Json;
  const [x = 0, y = 0, z = 0] = listOf(from['at_mm'] ?? from['tip_mm']).map(Number);
  return {
    kind: String(from['kind']),
    fromLine: Number(from['from_line']),
    toLine: Number(from['to_line']),
    tool: Number(from['tool']),
    amount: Number(from['amount']),
    limit: Number(from['limit'] ?? 0),
    unit: String(from['unit']),
    place: [x, y, z],
  };
}

function detailsOf(value: unknown): ProgramDetails {
  const from = value as Json;
  return {
    program: programOf(value),
    tools: listOf(from['tools']).map(Number),
    readAs: typeof from['read_as'] === 'string' ? from['read_as'] : '',
    target: typeof from['target'] === 'string' ? from['target'] : '',
    targetToleranceMm: Number(from['target_tolerance_mm'] ?? 0),
    warnings: listOf(from['warnings']).map(String),
    alarms: listOf(from['alarms']).map(alarmOf),
    mayControl: from['may_control'] !== false,
  };
}

/** The programs of one session. All functions reject with a ServerError. */
export class ProgramRequests {
  private readonly folder_: string;

  constructor(private readonly session: string) {
    this.folder_ = `/v1/sessions/${encodeURIComponent(session)}/programs`;
  }

  async list(): Promise<ProgramDetails[]> {
    const body = (await this.json_('GET', '')) as Json;
    return listOf(body['programs']).map(detailsOf);
  }

  async details(id: number): Promise<ProgramDetails> {
    return detailsOf(await this.json_('GET', `/${id}`));
  }

  async source(id: number): Promise<string> {
    return (await this.ask_('GET', `/${id}/source`)).text();
  }

  async path(id: number): Promise<ProgramPath> {
    return pathOfAnswer(await this.json_('GET', `/${id}/path?points=${PATH_POINTS}`));
  }

  /** Forces and removal along a participant's cuts; null if there are none yet. */
  async cut(participant: number): Promise<ForceCurve | null> {
    const strokes = await listStrokes(this.session);
    const own = strokes.filter((stroke) => stroke.participant === participant);
    const from = own[0]?.id;
    if (from === undefined) return null;
    const to = own.reduce((last, stroke) => Math.max(last, stroke.last), from);
    return forceCurve(this.session, CUT_POINTS, { participant, from, to });
  }

  /** `query`: as in server/http/README.md, e.g. `do=pause`. */
  async change(id: number, query: string): Promise<ProgramDetails> {
    return detailsOf(await this.json_('PATCH', `/${id}?${query}`));
  }

  async cancel(id: number): Promise<ProgramDetails> {
    return detailsOf(await this.json_('DELETE', `/${id}`));
  }

  async upload(file: File, query: string): Promise<ProgramDetails> {
    const name = encodeURIComponent(uploadName(file.name));
    return detailsOf(await this.json_('POST', `?name=${name}&${query}`, file));
  }

  private async json_(method: string, path: string, body?: Blob): Promise<unknown> {
    return (await this.ask_(method, path, body)).json();
  }

  private ask_(method: string, path: string, body?: Blob): Promise<Response> {
    return ask(method, this.folder_ + path, body ?? null);
  }
}

/** A file name as the server takes it: at most 64 bytes, with the same extension. */
export function uploadName(name: string): string {
  const plain = name.replace(/[\\/\r\n]/g, '_');
  const dot = plain.lastIndexOf('.');
  const extension = dot > 0 ? plain.slice(dot) : '';
  return nameThatFits(nameThatFits(dot > 0 ? plain.slice(0, dot) : plain, extension));
}
