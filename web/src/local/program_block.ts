// SPDX-License-Identifier: Apache-2.0
// A block in kerf_files.wasm, of a program or of a journal: typed calls of what
// web/wasm/files/exports.h declares.

import { hashText, trianglesOf } from '../kernel/kernel';
import type { TileTriangles } from '../kernel/kernel';
import type { Stock, ToolInfo, ToolState, Vec3 } from '../wire/types';
import { MemoryFolder } from './memory_folder';

/** A file that the user has given. */
export interface GivenFile {
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
}

/** The files of a block. `others` are files that a program or scene may name. */
export interface GivenFiles {
  program: GivenFile | null;
  scene: GivenFile | null;
  stock: GivenFile | null;
  /** A .kerf file, which has all of these. */
  journal: GivenFile | null;
  others: GivenFile[];
}

/** A journal as a replay needs it. */
export interface GivenJournal {
  /** Its scene and the files that this names (server/store/journal_origin.h). */
  origin: Uint8Array<ArrayBuffer>;
  /** Rows of records (server/store/record_span.h), in order; they may overlap. */
  spans: Uint8Array<ArrayBuffer>[];
}

/** The contents of a .kerf file of a journal, but for its participants. */
export interface JournalParts {
  /** Identity of the session, and its scene, as UTF-8. */
  id: Uint8Array<ArrayBuffer>;
  scene: Uint8Array<ArrayBuffer>;
  sceneCrc: number;
  files: {
    name: Uint8Array<ArrayBuffer>;
    bytes: Uint8Array<ArrayBuffer>;
    crc: number;
  }[];
  /** As GivenJournal.spans. */
  rows: Uint8Array<ArrayBuffer>;
  /** The tools that the hand has made, as rows of their table (manual/kerf-file.md). */
  tools: { tool: number; record: number; createdMs: number; json: string; crc: number }[];
  /** The last record, and the state after it. */
  record: number;
  hash: string;
  kernelVersion: number;
}

/** The facts that were read or assumed. */
export interface About {
  name: string;
  stock: Stock;
  tools: ToolInfo[];
  rays: 'dexel' | 'tri-dexel';
  pitch_mm: number;
  tolerance_mm: number;
  pivot_mm: number;
  /** Of a journal: its records. */
  motions: number;
  lines: number;
  /** Of all motions, at feed rate. */
  machining_s: number;
  /** The assumptions, a line each. */
  notes: string[];
  warnings: string[];
  /** Of a journal: the version that replays it. */
  kernel_version?: number;
  /** The tools that were made by hand, if the block comes from a journal. */
  made?: { tool: number; record: number; created_ms: number }[];
  grid: { origin_mm: Vec3; columns: [number, number]; tile: number };
}

/** How far the program or the journal has been carved. */
export interface Progress {
  carved: number;
  machining_s: number;
  /** On the block's own clock: of feeds, or since the first record of a journal. */
  time_s: number;
  /** When the next step ends; null at the end. */
  next_s: number | null;
  removed_mm3: number;
  /** Of the program's text; 0: unknown. */
  line: number;
  /** Where the tool is; missing before the first motion. */
  tool?: number;
  tip_mm?: Vec3;
  axis?: Vec3;
  /** Of a journal: when the record was appended, ms since 1970; 0: unknown. */
  time_ms?: number;
  /** Of a journal: the tools that have moved, with the forces of their last motions. */
  tools?: Omit<ToolState, 'felt_share'>[];
}

/** The state of a tile's columns in 16 digits, as mesh frames have it. */
export interface TileDigest {
  x: number;
  y: number;
  digest: string;
}

export type TakeHomeFormat = 'stl' | '3mf';

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  kerf_input(bytes: number): number;
  kerf_output(): number;
  kerf_read(): number;
  kerf_journal(): number;
  kerf_records(): number;
  kerf_make(): number;
  kerf_carve(steps: number, feels: number): number;
  kerf_play(untilS: number, steps: number): number;
  kerf_seek(step: number): number;
  kerf_hand(participant: number, wallMs: number): number;
  kerf_samples(wallMs: number, spanMs: number): number;
  kerf_change(undone: number, wallMs: number): number;
  kerf_tool(wallMs: number): number;
  kerf_origin(): number;
  kerf_rows(): number;
  kerf_checksum(): number;
  kerf_changed(): number;
  kerf_mesh(x: number, y: number): number;
  kerf_digest(x: number, y: number): bigint;
  kerf_hash(): bigint;
  kerf_about(): number;
  kerf_progress(): number;
  kerf_path(): number;
  kerf_write(): number;
}

/** The texts of an origin (server/store/journal_origin.h). */
function textsOf(origin: Uint8Array<ArrayBuffer>): Uint8Array<ArrayBuffer>[] {
  const numbers = new DataView(origin.buffer);
  let at = 4;
  return Array.from({ length: numbers.getUint32(0, true) }, () => {
    const size = numbers.getUint32(at, true);
    at += 4 + size;
    return origin.slice(at - size, at);
  });
}

/** The bytes under the checksum of a tool's row: its texts, the author's last, then its numbers. */
function rowBytes(json: string, ...numbers: number[]): Uint8Array {
  const texts = new TextEncoder().encode(`${json}\0\0`);
  const bytes = new Uint8Array(texts.length + 8 * numbers.length);
  bytes.set(texts);
  const view = new DataView(bytes.buffer, texts.length);
  numbers.forEach((value, n) => view.setBigInt64(8 * n, BigInt(value), true));
  return bytes;
}

/** Errors of calls are Errors whose message is one line, that of kerf-carve. */
export class ProgramBlock {
  private constructor(
    private readonly calls: Exports,
    private readonly folder: MemoryFolder,
  ) {}

  static async of(module: WebAssembly.Module): Promise<ProgramBlock> {
    const folder = new MemoryFolder();
    const instance = await WebAssembly.instantiate(module, folder.imports(module));
    const calls = instance.exports as unknown as Exports;
    folder.memory = calls.memory;
    calls._initialize();
    return new ProgramBlock(calls, folder);
  }

  /** Reads the program and its scene, or derives the scene. */
  read({ program, scene, stock, others }: GivenFiles): void {
    for (const file of [program, scene, stock, ...others])
      if (file) this.folder.put(file.name, file.bytes);
    const names = [program, scene, stock].map((file) => file?.name ?? '');
    this.put_(names.join('\n'));
    this.check_(this.calls.kerf_read());
  }

  /** Makes the block from the files that were read. The other calls need it. */
  make(): void {
    this.check_(this.calls.kerf_make());
  }

  /** Reads a journal in place of files. */
  readJournal({ origin, spans }: GivenJournal): void {
    this.give_(origin);
    this.check_(this.calls.kerf_journal());
    for (const span of spans) this.addRecords(span);
  }

  /** Adds records to a journal that was read. */
  addRecords(span: Uint8Array): void {
    this.give_(span);
    this.check_(this.calls.kerf_records());
  }

  /** Carves so many steps more, at most, without forces. */
  carve(steps: number): void {
    this.check_(this.calls.kerf_carve(steps, 0));
  }

  /** Carves the next steps that end by a time on the block's clock, at most so many, with forces. */
  play(untilS: number, steps: number): void {
    this.check_(this.calls.kerf_play(untilS, steps));
  }

  /** Goes to a step or to one before it, from which carving goes on. */
  seek(step: number): void {
    this.check_(this.calls.kerf_seek(step));
  }

  /**
   * A hand carves from now on, as this participant. The block of a program becomes a journal of its
   * motions so far, which is to be made and carved again.
   */
  hand(participant: number, wallMs: number): void {
    this.check_(this.calls.kerf_hand(participant, wallMs));
  }

  /** Carves a frame of motions of the hand; the block must be at its last record. */
  samples(frame: Uint8Array, wallMs: number, spanMs: number): void {
    this.give_(frame);
    this.check_(this.calls.kerf_samples(wallMs, spanMs));
  }

  /** Undoes the newest stroke of the hand, or redoes the one that was undone last. */
  change(undone: boolean, wallMs: number): void {
    this.check_(this.calls.kerf_change(undone ? 1 : 0, wallMs));
  }

  /** Makes a tool for the hand, unless there is an equal one. Returns its id. */
  tool(tool: string, wallMs: number): number {
    this.put_(tool);
    this.check_(this.calls.kerf_tool(wallMs));
    return new Uint32Array(this.output_(4).buffer)[0]!;
  }

  /** The journal of a block that a hand carves, which must be at its last record. */
  parts(): JournalParts {
    const [id, scene, ...files] = textsOf(this.output_(this.calls.kerf_origin()));
    return {
      id: id!,
      scene: scene!,
      sceneCrc: this.checksum_(scene!),
      files: files.flatMap((name, n) => {
        if (n % 2 === 1) return [];
        const bytes = files[n + 1]!;
        return [{ name, bytes, crc: this.checksum_(bytes) }];
      }),
      rows: this.output_(this.calls.kerf_rows()),
      tools: this.madeTools_(),
      record: this.progress().carved,
      hash: this.hash(),
      kernelVersion: this.about().kernel_version!,
    };
  }

  private madeTools_(): JournalParts['tools'] {
    const { made = [], tools } = this.about();
    return made.map(({ tool, record, created_ms: createdMs }) => {
      const json = JSON.stringify(tools.find(({ id }) => id === tool));
      return {
        tool,
        record,
        createdMs,
        json,
        crc: this.checksum_(rowBytes(json, tool, record, createdMs)),
      };
    });
  }

  /** Meshes of the tiles that have changed since the last call; the first time of all. */
  changed(): TileTriangles[] {
    return this.changedTiles_().map(([x, y]) => this.mesh(x, y));
  }

  /** The mesh of a tile as it was at the last changed() or digests(). */
  mesh(x: number, y: number): TileTriangles {
    const vertices = this.calls.kerf_mesh(x, y);
    return trianglesOf(x, y, vertices, (bytes) => this.output_(bytes));
  }

  /** Digests of the tiles that have changed since the last call; the first time of all. */
  digests(): TileDigest[] {
    return this.changedTiles_().map(([x, y]) => {
      return { x, y, digest: hashText(this.calls.kerf_digest(x, y)) };
    });
  }

  private changedTiles_(): [x: number, y: number][] {
    const count = this.calls.kerf_changed();
    const places = new Int32Array(this.output_(8 * count).buffer);
    return Array.from({ length: count }, (_, n) => [places[2 * n]!, places[2 * n + 1]!]);
  }

  hash(): string {
    return hashText(this.calls.kerf_hash());
  }

  about(): About {
    return this.json_(this.calls.kerf_about()) as About;
  }

  progress(): Progress {
    return this.json_(this.calls.kerf_progress()) as Progress;
  }

  /** As `GET …/path` of a server answers (model/program_path.ts). */
  path(): unknown {
    return this.json_(this.calls.kerf_path());
  }

  /** The block as a model file. */
  model(format: TakeHomeFormat): Uint8Array<ArrayBuffer> {
    this.put_(format);
    this.check_(this.calls.kerf_write());
    return this.folder.take('model')!;
  }

  private put_(text: string): void {
    this.give_(new TextEncoder().encode(text));
  }

  private give_(bytes: Uint8Array): void {
    const at = this.calls.kerf_input(bytes.length);
    new Uint8Array(this.calls.memory.buffer, at, bytes.length).set(bytes);
  }

  private checksum_(bytes: Uint8Array): number {
    this.give_(bytes);
    return this.calls.kerf_checksum() >>> 0;
  }

  private check_(errorBytes: number): void {
    if (errorBytes > 0) throw new Error(this.text_(errorBytes));
  }

  private json_(bytes: number): unknown {
    return JSON.parse(this.text_(bytes));
  }

  private text_(bytes: number): string {
    return new TextDecoder().decode(this.output_(bytes));
  }

  /** A copy: the module's memory may move. */
  private output_(bytes: number): Uint8Array<ArrayBuffer> {
    const at = this.calls.kerf_output();
    return new Uint8Array(this.calls.memory.buffer, at, bytes).slice();
  }
}
