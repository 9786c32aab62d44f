// SPDX-License-Identifier: Apache-2.0
// A block as a height field, carved by a ball: content for the fake server. Not part of the
// product.

export class FakeBlock {
  constructor({ sizeMm = 100, heightMm = 50, pitchMm = 0.5, tile = 32 } = {}) {
    Object.assign(this, { sizeMm, heightMm, pitchMm, tile });
    this.columns = Math.round(sizeMm / pitchMm);
    this.tilesPerSide = Math.ceil(this.columns / tile);
    // Z of the surface at grid points; 0 is the untouched top.
    this.heights = new Float64Array((this.columns + 1) ** 2);
    this.versions = new Map();
    this.removedMm3 = 0;
    for (let y = 0; y < this.tilesPerSide; ++y) {
      for (let x = 0; x < this.tilesPerSide; ++x) this.versions.set(`${x},${y}`, 1);
    }
  }

  /**
   * Cuts with a ball whose lowest point is the tip. Adds changed tiles to `dirty`; returns the
   * removed volume, mm³.
   */
  cut(tip, radius, dirty) {
    const { pitchMm, columns, sizeMm } = this;
    const at = (mm) => (mm + sizeMm / 2) / pitchMm;
    const reach = radius / pitchMm;
    let removed = 0;
    for (
      let j = Math.max(0, Math.ceil(at(tip[1]) - reach));
      j <= Math.min(columns, at(tip[1]) + reach);
      ++j
    ) {
      for (
        let i = Math.max(0, Math.ceil(at(tip[0]) - reach));
        i <= Math.min(columns, at(tip[0]) + reach);
        ++i
      ) {
        const dx = i * pitchMm - sizeMm / 2 - tip[0];
        const dy = j * pitchMm - sizeMm / 2 - tip[1];
        const rest = radius * radius - dx * dx - dy * dy;
        if (rest <= 0) continue;
        const z = Math.max(-this.heightMm, tip[2] + radius - Math.sqrt(rest));
        const index = j * (columns + 1) + i;
        if (z >= this.heights[index]) continue;
        removed += (this.heights[index] - z) * pitchMm * pitchMm;
        this.heights[index] = z;
        this.markDirty_(i, j, dirty);
      }
    }
    this.removedMm3 += removed;
    return removed;
  }

  markDirty_(i, j, dirty) {
    const last = this.tilesPerSide - 1;
    for (const x of [Math.floor((i - 1) / this.tile), Math.floor((i + 1) / this.tile)]) {
      for (const y of [Math.floor((j - 1) / this.tile), Math.floor((j + 1) / this.tile)]) {
        dirty.add(`${Math.min(last, Math.max(0, x))},${Math.min(last, Math.max(0, y))}`);
      }
    }
  }

  height(i, j) {
    const clamp = (v) => Math.min(this.columns, Math.max(0, v));
    return this.heights[clamp(j) * (this.columns + 1) + clamp(i)];
  }

  /**
   * Returns the mesh of one tile: its part of the top, the floor, and walls at the block's border.
   */
  mesh(key) {
    const [x, y] = key.split(',').map(Number);
    const mesh = {
      ...{ x, y, version: this.versions.get(key) },
      ...{ positions: [], normals: [], indices: [], original: [] },
    };
    const i0 = x * this.tile;
    const j0 = y * this.tile;
    const i1 = Math.min(this.columns, i0 + this.tile);
    const j1 = Math.min(this.columns, j0 + this.tile);
    const mm = (index) => index * this.pitchMm - this.sizeMm / 2;
    for (let j = j0; j <= j1; ++j) {
      for (let i = i0; i <= i1; ++i) {
        const nx = this.height(i - 1, j) - this.height(i + 1, j);
        const ny = this.height(i, j - 1) - this.height(i, j + 1);
        const length = Math.hypot(nx, ny, 2 * this.pitchMm);
        mesh.positions.push(mm(i), mm(j), this.height(i, j));
        mesh.normals.push(nx / length, ny / length, (2 * this.pitchMm) / length);
        mesh.original.push(this.height(i, j) === 0 ? 1 : 0);
      }
    }
    const width = i1 - i0 + 1;
    for (let j = 0; j < j1 - j0; ++j) {
      for (let i = 0; i < i1 - i0; ++i) {
        const a = j * width + i;
        mesh.indices.push(a, a + 1, a + width + 1, a, a + width + 1, a + width);
      }
    }
    this.addWalls_(mesh, i0, i1, j0, j1, mm);
    return mesh;
  }

  addWalls_(mesh, i0, i1, j0, j1, mm) {
    const floor = -this.heightMm;
    const quad = (corners, normal) => {
      const first = mesh.positions.length / 3;
      for (const corner of corners) {
        mesh.positions.push(...corner);
        mesh.normals.push(...normal);
      }
      mesh.indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
    };
    for (let i = i0; i < i1; ++i) {
      const top = (n, j) => [mm(n), mm(j), this.height(n, j)];
      const low = (n, j) => [mm(n), mm(j), floor];
      if (j0 === 0) quad([low(i, 0), low(i + 1, 0), top(i + 1, 0), top(i, 0)], [0, -1, 0]);
      if (j1 === this.columns)
        quad([low(i + 1, j1), low(i, j1), top(i, j1), top(i + 1, j1)], [0, 1, 0]);
    }
    for (let j = j0; j < j1; ++j) {
      const top = (i, n) => [mm(i), mm(n), this.height(i, n)];
      const low = (i, n) => [mm(i), mm(n), floor];
      if (i0 === 0) quad([low(0, j + 1), low(0, j), top(0, j), top(0, j + 1)], [-1, 0, 0]);
      if (i1 === this.columns)
        quad([low(i1, j), low(i1, j + 1), top(i1, j + 1), top(i1, j)], [1, 0, 0]);
    }
    quad(
      [
        [mm(i0), mm(j1), floor],
        [mm(i1), mm(j1), floor],
        [mm(i1), mm(j0), floor],
        [mm(i0), mm(j0), floor],
      ],
      [0, 0, -1],
    );
  }
}
