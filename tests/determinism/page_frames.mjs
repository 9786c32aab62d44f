// SPDX-License-Identifier: Apache-2.0
// Inputs of page_job and kerf.wasm: frames as a page sends and receives them, and jobs of frames.

/** The text of a welcome. `stock` has the corners of a box. */
export function welcome(rays, pitch_mm, [min_mm, max_mm], tools) {
  return Buffer.from(
    JSON.stringify({
      type: 'welcome',
      stock: { shape: 'box', min_mm, max_mm },
      accuracy: { rays, pitch_mm, tolerance_mm: 0.01, motion: 'tight' },
      tools,
      force: { law: 'specific_energy', specific_force_n_per_mm2: 0.5, drr_n_s_per_mm3: 0.01 },
      limits: { speed_mm_per_s: 5000 },
    }),
  );
}

export function frame(type, flags, payload) {
  const header = Buffer.alloc(32);
  header.write('KRF1', 0);
  header.writeUInt8(type, 4);
  header.writeUInt8(flags, 5);
  header.writeUInt16LE(32, 6);
  header.writeUInt32LE(payload.length, 8);
  header.writeUInt32LE(1, 12);
  return Buffer.concat([header, payload]);
}

/** Samples, 1 ms after each other, of a tool that cuts. */
export function motion(samples) {
  const payload = Buffer.alloc(8 + 64 * samples.length);
  payload.writeUInt32LE(samples.length, 0);
  samples.forEach(({ sequence, tip, axis, tool }, n) => {
    const at = 8 + 64 * n;
    payload.writeBigUInt64LE(sequence, at);
    payload.writeBigUInt64LE(sequence * 1000n, at + 8);
    tip.forEach((value, i) => payload.writeDoubleLE(value, at + 16 + 8 * i));
    axis.forEach((value, i) => payload.writeFloatLE(value, at + 40 + 4 * i));
    payload.writeUInt32LE(tool, at + 52);
    payload.writeUInt32LE(1, at + 56);
  });
  return frame(1, 0, payload);
}

function leb(value) {
  const bytes = [];
  for (; value >= 0x80; value = Math.floor(value / 128)) bytes.push((value % 128) | 0x80);
  return [...bytes, value];
}

/** Tiles of stock. `top` has the remaining quanta of each column, or null for no change. */
export function stock(flags, timeUs, tiles) {
  const parts = [Buffer.alloc(16)];
  parts[0].writeBigUInt64LE(timeUs, 0);
  parts[0].writeUInt32LE(tiles.length, 8);
  for (const [axis, x, y, top] of tiles) {
    const columns =
      top === null ? [] : [(1 << 2) | 1, ...leb(0), ...leb(2 * top), ...leb((1023 << 2) | 2)];
    const head = Buffer.alloc(16);
    [axis, x, y, columns.length].forEach((value, n) => head.writeUInt32LE(value, 4 * n));
    parts.push(head, Buffer.from(columns));
  }
  return frame(8, flags, Buffer.concat(parts));
}

/** All tiles of a block with these numbers of tiles along its sides. */
export function everyTile(rays, [along_x, along_y, along_z]) {
  const sides = [
    [2, along_x, along_y],
    [0, along_y, along_z],
    [1, along_z, along_x],
  ];
  return sides
    .slice(0, rays === 'dexel' ? 1 : 3)
    .flatMap(([axis, nx, ny]) =>
      Array.from({ length: nx * ny }, (_, n) => [axis, n % nx, Math.floor(n / nx)]),
    );
}

/** The file that page_job reads, of [kind, bytes] each. */
export function jobFile(sent) {
  const parts = sent.map(([kind, bytes]) => {
    const head = Buffer.alloc(5);
    head.write(kind, 0);
    head.writeUInt32LE(bytes.length, 1);
    return Buffer.concat([head, bytes]);
  });
  return Buffer.concat(parts);
}

/** The functions of kerf.wasm, with helpers that pass bytes to them and read their results. */
export async function openKernel(bytes) {
  const module = await WebAssembly.compile(bytes);
  const system = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module))
    (system[from] ??= {})[name] = () => 8;
  const { exports: calls } = await WebAssembly.instantiate(module, system);
  calls._initialize();
  const put = (input) => {
    const at = calls.kerf_input(input.length);
    new Uint8Array(calls.memory.buffer, at, input.length).set(input);
  };
  const output = (count) => new Uint8Array(calls.memory.buffer, calls.kerf_output(), count).slice();
  return { calls, put, output };
}
