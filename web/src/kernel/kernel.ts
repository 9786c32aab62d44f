// SPDX-License-Identifier: Apache-2.0
// The block in kerf.wasm: typed calls of what web/wasm/exports.h declares.

/** The triangles of a tile, mm from the block's minimum corner. */
export interface TileTriangles {
  x: number;
  y: number;
  /** Three numbers a vertex. */
  positions: Float32Array<ArrayBuffer>;
  /** Unit vectors, likewise. */
  normals: Float32Array<ArrayBuffer>;
  /** Three vertices a triangle, counterclockwise seen from outside. */
  index: Uint32Array<ArrayBuffer>;
  /** Of each vertex: 1 where the surface is that of the untouched stock, 0 where it was cut. */
  original: Uint8Array<ArrayBuffer>;
}

export interface ChangedTile {
  x: number;
  y: number;
  /** Whether a motion of the page has changed it. */
  byPage: boolean;
}

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  kerf_input(bytes: number): number;
  kerf_output(): number;
  kerf_open(): number;
  kerf_tools(): number;
  kerf_take(): number;
  kerf_force(): number;
  kerf_change(undone: boolean): void;
  kerf_settle(): void;
  kerf_changed(): number;
  kerf_mesh(x: number, y: number): number;
  kerf_hash(): bigint;
}

const NO_SUCH_FILE = 8; // WASI's EBADF: the module has no files

/** The system calls of the C library. Only a failed assertion would write. */
function imports(module: WebAssembly.Module): WebAssembly.Imports {
  const all: Record<string, Record<string, () => number>> = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    (all[from] ??= {})[name] = () => NO_SUCH_FILE;
  return all;
}

/** Reads what kerf_mesh has put into the output; `output` returns a copy of its first bytes. */
export function trianglesOf(
  x: number,
  y: number,
  vertices: number,
  output: (bytes: number) => Uint8Array<ArrayBuffer>,
): TileTriangles {
  const [corners] = new Uint32Array(output(4).buffer);
  const indexAt = 4 + 24 * vertices;
  const originalAt = indexAt + 4 * corners!;
  const { buffer } = output(originalAt + vertices);
  return {
    x,
    y,
    positions: new Float32Array(buffer.slice(4, 4 + 12 * vertices)),
    normals: new Float32Array(buffer.slice(4 + 12 * vertices, indexAt)),
    index: new Uint32Array(buffer.slice(indexAt, originalAt)),
    original: new Uint8Array(buffer.slice(originalAt)),
  };
}

/** The memory of tiles, which a worker gives away instead of copying it. */
export function buffersOf(tiles: readonly TileTriangles[]): ArrayBuffer[] {
  return tiles.flatMap(({ positions, normals, index, original }) =>
    [positions, normals, index, original].map(({ buffer }) => buffer),
  );
}

/** A state's hash, as the server writes it. */
export function hashText(hash: bigint): string {
  return BigInt.asUintN(64, hash).toString(16).padStart(16, '0');
}

export class Kernel {
  private constructor(private readonly calls: Exports) {}

  static async of(module: WebAssembly.Module): Promise<Kernel> {
    const instance = await WebAssembly.instantiate(module, imports(module));
    const calls = instance.exports as unknown as Exports;
    calls._initialize();
    return new Kernel(calls);
  }

  /** Opens the block of an agent's welcome, in place of the one before. Throws if it cannot. */
  open(welcome: string): void {
    this.put_(new TextEncoder().encode(welcome));
    this.check_(this.calls.kerf_open());
  }

  /** Defines the tools of a `tools` message that are new. Throws if it cannot. */
  tools(message: string): void {
    this.put_(new TextEncoder().encode(message));
    this.check_(this.calls.kerf_tools());
  }

  /**
   * Takes a frame as it was sent: the page's motions, or the server's stock and results. False: the
   * page must ask for a reset of its stock.
   */
  take(frame: Uint8Array): boolean {
    this.put_(frame);
    return this.calls.kerf_take() !== 0;
  }

  /** The greatest cutting force of the motions in the page's newest frame, N. */
  force(): number {
    return this.calls.kerf_force();
  }

  /**
   * The page asks the server to undo its newest stroke, or to redo the one that it undid last: its
   * tiles change at once, the state when the server's stock comes.
   */
  change(undone: boolean): void {
    this.calls.kerf_change(undone);
  }

  /** The server has refused, or has sent all: the tiles are those of the state. */
  settle(): void {
    this.calls.kerf_settle();
  }

  /** The tiles whose mesh has changed since the last call, as far as their stock is known. */
  changed(): ChangedTile[] {
    const count = this.calls.kerf_changed();
    const numbers = new Int32Array(this.output_(12 * count).buffer);
    return Array.from({ length: count }, (_, n) => {
      const [x, y, byPage] = numbers.subarray(3 * n);
      return { x: x!, y: y!, byPage: byPage !== 0 };
    });
  }

  /** The mesh of a tile at the last changed(). */
  mesh(x: number, y: number): TileTriangles {
    return trianglesOf(x, y, this.calls.kerf_mesh(x, y), (bytes) => this.output_(bytes));
  }

  /** The hash of the block's state, as the server writes it. */
  hash(): string {
    return hashText(this.calls.kerf_hash());
  }

  private check_(errorBytes: number): void {
    if (errorBytes > 0) throw new Error(new TextDecoder().decode(this.output_(errorBytes)));
  }

  private put_(bytes: Uint8Array): void {
    const at = this.calls.kerf_input(bytes.length);
    new Uint8Array(this.calls.memory.buffer, at, bytes.length).set(bytes);
  }

  /** A copy: the module's memory may move. */
  private output_(bytes: number): Uint8Array<ArrayBuffer> {
    const at = this.calls.kerf_output();
    return new Uint8Array(this.calls.memory.buffer, at, bytes).slice();
  }
}
