// SPDX-License-Identifier: Apache-2.0
// The program and its block in kerf_files.wasm: typed calls of what web/wasm/files/exports.h
// declares.

import { hashText, trianglesOf } from '../kernel/kernel';
import type { TileTriangles } from '../kernel/kernel';
import type { Stock, ToolInfo, Vec3 } from '../wire/types';
import { MemoryFolder } from './memory_folder';

/** A file that the user has given. */
export interface GivenFile {
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
}

/** The files of a block. Those beside a program or scene, which it may name, are `others`. */
export interface GivenFiles {
  program: GivenFile | null;
  scene: GivenFile | null;
  stock: GivenFile | null;
  others: GivenFile[];
}

/** What was read, and what was assumed. */
export interface About {
  name: string;
  stock: Stock;
  tools: ToolInfo[];
  rays: 'dexel' | 'tri-dexel';
  pitch_mm: number;
  tolerance_mm: number;
  pivot_mm: number;
  motions: number;
  lines: number;
  /** Of all motions, at feed rate. */
  machining_s: number;
  /** What was assumed, a line each. */
  notes: string[];
  warnings: string[];
  grid: { origin_mm: Vec3; columns: [number, number]; tile: number };
}

/** How far the program has been carved. */
export interface Progress {
  carved: number;
  machining_s: number;
  removed_mm3: number;
  /** Of the program's text; 0: unknown. */
  line: number;
  /** Where the tool is; missing before the first motion. */
  tool?: number;
  tip_mm?: Vec3;
  axis?: Vec3;
}

export type TakeHomeFormat = 'stl' | '3mf';

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  kerf_input(bytes: number): number;
  kerf_output(): number;
  kerf_read(): number;
  kerf_make(): number;
  kerf_carve(motions: number): number;
  kerf_seek(motion: number): void;
  kerf_changed(): number;
  kerf_mesh(x: number, y: number): number;
  kerf_hash(): bigint;
  kerf_about(): number;
  kerf_progress(): number;
  kerf_path(): number;
  kerf_write(): number;
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

  /** Makes the block of what was read. The other calls need it. */
  make(): void {
    this.check_(this.calls.kerf_make());
  }

  /** Carves so many motions more, at most. */
  carve(motions: number): void {
    this.check_(this.calls.kerf_carve(motions));
  }

  /** Goes back to a state before a motion, or to a later one that is known; carving goes on there. */
  seek(motion: number): void {
    this.calls.kerf_seek(motion);
  }

  /** Meshes of the tiles that have changed since the last call; the first time of all. */
  changed(): TileTriangles[] {
    const count = this.calls.kerf_changed();
    const places = new Int32Array(this.output_(8 * count).buffer);
    return Array.from({ length: count }, (_, n) => {
      const [x, y] = [places[2 * n]!, places[2 * n + 1]!];
      const vertices = this.calls.kerf_mesh(x, y);
      return trianglesOf(x, y, vertices, (bytes) => this.output_(bytes));
    });
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
    const bytes = new TextEncoder().encode(text);
    const at = this.calls.kerf_input(bytes.length);
    new Uint8Array(this.calls.memory.buffer, at, bytes.length).set(bytes);
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
