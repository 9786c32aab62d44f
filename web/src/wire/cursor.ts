// SPDX-License-Identifier: Apache-2.0
// Reads and writes little-endian fields in the order of the tables in server/wire/README.md.

import type { Vec3 } from './types';

/** Reads consecutive fields and records the position of the first non-finite number. */
export class Reader {
  /** Offset of the first NaN or infinity, or -1. */
  notFiniteAt = -1;

  constructor(
    private readonly view: DataView,
    public at: number,
  ) {}

  u32(): number {
    this.at += 4;
    return this.view.getUint32(this.at - 4, true);
  }

  u64(): bigint {
    this.at += 8;
    return this.view.getBigUint64(this.at - 8, true);
  }

  f32(): number {
    const value = this.view.getFloat32(this.at, true);
    this.check_(value);
    this.at += 4;
    return value;
  }

  f64(): number {
    const value = this.view.getFloat64(this.at, true);
    this.check_(value);
    this.at += 8;
    return value;
  }

  /** Returns the next `count` bytes as a view. */
  bytes(count: number): Uint8Array {
    this.at += count;
    return new Uint8Array(this.view.buffer, this.view.byteOffset + this.at - count, count);
  }

  vec3f(): Vec3 {
    return [this.f32(), this.f32(), this.f32()];
  }

  vec3d(): Vec3 {
    return [this.f64(), this.f64(), this.f64()];
  }

  private check_(value: number): void {
    if (!Number.isFinite(value) && this.notFiniteAt < 0) this.notFiniteAt = this.at;
  }
}

/** Writes consecutive fields. */
export class Writer {
  constructor(
    private readonly view: DataView,
    public at: number,
  ) {}

  u32(value: number): void {
    this.view.setUint32(this.at, value, true);
    this.at += 4;
  }

  u64(value: bigint): void {
    this.view.setBigUint64(this.at, value, true);
    this.at += 8;
  }

  f32(value: number): void {
    this.view.setFloat32(this.at, value, true);
    this.at += 4;
  }

  bytes(values: Uint8Array): void {
    new Uint8Array(this.view.buffer, this.view.byteOffset).set(values, this.at);
    this.at += values.byteLength;
  }

  vec3f(v: Vec3): void {
    for (const value of v) this.f32(value);
  }

  vec3d(v: Vec3): void {
    for (const value of v) {
      this.view.setFloat64(this.at, value, true);
      this.at += 8;
    }
  }
}
