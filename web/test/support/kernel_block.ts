// SPDX-License-Identifier: Apache-2.0
// A block of any shape in kerf.wasm: the columns of a shape as a server would send them, motions as
// a page sends them, and the surface as rays meet it.

import { readFileSync } from 'node:fs';
import { Kernel } from '../../src/kernel/kernel';
import type { TileTriangles } from '../../src/kernel/kernel';
import type { Draft } from '../../src/carve/sample_log';
import { Surface } from '../../src/carve/surface';
import type { Piece } from '../../src/model/surface';
import { encodeFrame } from '../../src/wire/encode';
import { FrameType, STOCK_RESET } from '../../src/wire/types';
import type { StockTile, ToolInfo, Vec3 } from '../../src/wire/types';

export const KERNEL_FILE = new URL('../../public/kerf.wasm', import.meta.url);
const TILE = 32;
const DEPTH_BITS = 30; // kernel/dexel/stock_column.cpp
const SAMPLES_PER_FRAME = 16;

/** An ellipsoid, or an upright elliptic cylinder with these half axes. */
export interface Solid {
  kind: 'ellipsoid' | 'cylinder';
  center: Vec3;
  radii: Vec3;
}

export interface Box {
  min: Vec3;
  max: Vec3;
}

type Span = [from: number, to: number];

/** Where the line along an axis through (u, v) of the frame (axis + 1, axis + 2) is inside. */
function spanOf(
  { kind, center, radii }: Solid,
  axis: 0 | 1 | 2,
  u: number,
  v: number,
): Span | null {
  const [j, k] = [(axis + 1) % 3, (axis + 2) % 3] as [0 | 1 | 2, 0 | 1 | 2];
  const part = (n: 0 | 1 | 2, value: number): number => (value - center[n]) / radii[n];
  const [a, b] = [part(j, u), part(k, v)];
  let half: number;
  if (kind === 'ellipsoid') half = 1 - a * a - b * b;
  else if (axis === 2) half = a * a + b * b < 1 ? 1 : -1;
  else {
    const [across, along] = j === 2 ? [b, a] : [a, b];
    half = Math.abs(along) < 1 ? 1 - across * across : -1;
  }
  if (half <= 0) return null;
  const reach = Math.sqrt(half) * radii[axis];
  return [center[axis] - reach, center[axis] + reach];
}

function union(spans: Span[]): Span[] {
  const all: Span[] = [];
  for (const [from, to] of spans.sort((a, b) => a[0] - b[0])) {
    const last = all.at(-1);
    if (last && from <= last[1]) last[1] = Math.max(last[1], to);
    else all.push([from, to]);
  }
  return all;
}

class Tokens {
  readonly bytes: number[] = [];
  private before_: number[] = [];

  put(value: number): void {
    let left = value;
    for (; left >= 128; left = Math.floor(left / 128)) this.bytes.push((left % 128) + 128);
    this.bytes.push(left);
  }

  /** One column with these ends, as the wire protocol encodes them. */
  column(ends: readonly number[]): void {
    this.put((ends.length / 2) * 4 + 1);
    ends.forEach((end, n) => {
      const difference = end - (this.before_[n] ?? ends[n - 1] ?? 0);
      this.put(difference >= 0 ? 2 * difference : -2 * difference - 1);
    });
    this.before_ = [...ends];
  }
}

function tilesOf(solids: readonly Solid[], { min, max }: Box, pitch: number): StockTile[] {
  const tiles: StockTile[] = [];
  for (const axis of [0, 1, 2] as const) {
    const [j, k] = [(axis + 1) % 3, (axis + 2) % 3] as [0 | 1 | 2, 0 | 1 | 2];
    const size = max[axis] - min[axis];
    const quantum = 2 ** (Math.floor(Math.log2(size)) + 1 - DEPTH_BITS);
    const columns = [j, k].map((n) => Math.round((max[n as 0] - min[n as 0]) / pitch));
    const [across, rows] = columns as [number, number];
    for (let y = 0; y * TILE < rows; y += 1)
      for (let x = 0; x * TILE < across; x += 1) {
        const tokens = new Tokens();
        for (let n = 0; n < TILE * TILE; n += 1) {
          const u = min[j] + (x * TILE + (n % TILE) + 0.5) * pitch;
          const v = min[k] + (y * TILE + Math.floor(n / TILE) + 0.5) * pitch;
          const spans = solids.map((one) => spanOf(one, axis, u, v)).filter((one) => one !== null);
          const ends = union(spans).flat();
          tokens.column(ends.map((end) => Math.round((end - min[axis]) / quantum)));
        }
        tiles.push({ axis, x, y, columns: Uint8Array.from(tokens.bytes) });
      }
  }
  return tiles;
}

export interface BlockOptions {
  box: Box;
  pitch: number;
  tools: readonly ToolInfo[];
  solids: readonly Solid[];
}

export class KernelBlock {
  private readonly pieces_ = new Map<string, Piece>();
  private sequence_ = 0n;
  private readonly welcome_: string;
  private readonly stock_: Uint8Array;

  private constructor(
    private readonly kernel: Kernel,
    private readonly options: BlockOptions,
  ) {
    const { box, pitch, tools, solids } = options;
    this.welcome_ = JSON.stringify({
      type: 'welcome',
      stock: { shape: 'box', min_mm: box.min, max_mm: box.max },
      accuracy: { rays: 'tri-dexel', pitch_mm: pitch, tolerance_mm: 0.01, motion: 'tight' },
      tools,
      force: { law: 'specific_energy', specific_force_n_per_mm2: 0.5, drr_n_s_per_mm3: 0.01 },
      limits: { speed_mm_per_s: 5000 },
    });
    const header = {
      type: FrameType.Stock,
      flags: STOCK_RESET,
      epoch: 1,
      sequence: 1n,
      time_us: 1n,
    };
    const tiles = tilesOf(solids, box, pitch);
    this.stock_ = encodeFrame({
      header,
      kind: 'stock',
      ...{ reset: true, returned: false, agent_time_us: 0n, tiles },
    });
    this.reset();
  }

  static async of(options: BlockOptions): Promise<KernelBlock> {
    const module = await WebAssembly.compile(readFileSync(KERNEL_FILE));
    return new KernelBlock(await Kernel.of(module), options);
  }

  /** The uncut shape. */
  reset(): void {
    this.kernel.open(this.welcome_);
    this.kernel.take(this.stock_);
    this.sequence_ = 0n;
    this.pieces_.clear();
    const { min, max } = this.options.box;
    const [across, rows] = ([0, 1] as const).map((n) =>
      Math.ceil((max[n] - min[n]) / this.options.pitch / TILE),
    ) as [number, number];
    this.kernel.changed();
    for (let y = 0; y < rows; y += 1)
      for (let x = 0; x < across; x += 1) this.mesh_(this.kernel.mesh(x, y));
  }

  cut(drafts: readonly Draft[]): void {
    for (let at = 0; at < drafts.length; at += SAMPLES_PER_FRAME) {
      const samples = drafts
        .slice(at, at + SAMPLES_PER_FRAME)
        .map((draft) => ({ agent_sequence: ++this.sequence_, ...draft }));
      const header = { type: FrameType.Motion, flags: 0, epoch: 1, sequence: 1n, time_us: 1n };
      this.kernel.take(encodeFrame({ header, kind: 'motion', samples }));
    }
    for (const { x, y } of this.kernel.changed()) this.mesh_(this.kernel.mesh(x, y));
  }

  get hash(): string {
    return this.kernel.hash();
  }

  get pieces(): readonly Piece[] {
    return [...this.pieces_.values()];
  }

  get surface(): Surface {
    return new Surface(this.pieces);
  }

  private mesh_({ x, y, positions, index }: TileTriangles): void {
    const { min } = this.options.box;
    const corners = new Float64Array(3 * index.length);
    const box: Box = {
      min: [Infinity, Infinity, Infinity],
      max: [-Infinity, -Infinity, -Infinity],
    };
    index.forEach((vertex, n) => {
      for (const i of [0, 1, 2] as const) {
        const value = positions[3 * vertex + i]! + min[i];
        corners[3 * n + i] = value;
        box.min[i] = Math.min(box.min[i], value);
        box.max[i] = Math.max(box.max[i], value);
      }
    });
    this.pieces_.set(`${x},${y}`, { ...box, corners: () => corners });
  }
}
