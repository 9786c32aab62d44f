// SPDX-License-Identifier: Apache-2.0
// The sizes of a box or an upright cylinder, to be changed before a block is made of it.

import type { Scene } from './new_block';

interface Box {
  shape: 'box';
  min_mm: number[];
  max_mm: number[];
}

interface Cylinder {
  shape: 'cylinder';
  radius_mm: number;
  min_z_mm: number;
  max_z_mm: number;
}

/** The sides of a box along X, Y and Z, or the diameter and the height of a cylinder, mm. */
export function sizesOf(stock: unknown): number[] {
  if (isBox(stock)) return stock.max_mm.map((max, axis) => max - stock.min_mm[axis]!);
  if (isCylinder(stock)) return [2 * stock.radius_mm, stock.max_z_mm - stock.min_z_mm];
  return []; // of a model
}

/**
 * The stock with such sizes, of which sizesOf() returns as many. It grows from the origin: a corner
 * that is there stays there, a block around it stays around it, and its top stays at Z 0.
 */
export function resized(stock: unknown, sizes: readonly number[]): unknown {
  const factors = sizesOf(stock).map((size, n) => sizes[n]! / size);
  const scaled = (value: number, n: number): number => value * factors[n]! + 0;
  if (isBox(stock))
    return { ...stock, min_mm: stock.min_mm.map(scaled), max_mm: stock.max_mm.map(scaled) };
  if (!isCylinder(stock)) return stock;
  return {
    ...stock,
    radius_mm: scaled(stock.radius_mm, 0),
    min_z_mm: scaled(stock.min_z_mm, 1),
    max_z_mm: scaled(stock.max_z_mm, 1),
  };
}

function isBox(stock: unknown): stock is Box {
  return (stock as Scene | undefined)?.['shape'] === 'box';
}

function isCylinder(stock: unknown): stock is Cylinder {
  return (stock as Scene | undefined)?.['shape'] === 'cylinder';
}
