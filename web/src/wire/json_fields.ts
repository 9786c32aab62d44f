// SPDX-License-Identifier: Apache-2.0
// Typed access to the fields of JSON control messages; an invalid field throws InvalidField.

export type Json = Record<string, unknown>;

export class InvalidField extends Error {}

export function object(value: unknown, field: string): Json {
  if (typeof value !== 'object' || value === null || Array.isArray(value))
    throw new InvalidField(`${field} is not an object`);
  return value as Json;
}

export function list(value: unknown, field: string): unknown[] {
  if (!Array.isArray(value)) throw new InvalidField(`${field} is not an array`);
  return value;
}

export function number(from: Json, field: string): number {
  const value = from[field];
  if (typeof value !== 'number' || !Number.isFinite(value))
    throw new InvalidField(`${field} is not a number`);
  return value;
}

export function text(from: Json, field: string): string {
  const value = from[field];
  if (typeof value !== 'string') throw new InvalidField(`${field} is not a string`);
  return value;
}

export function numbers(from: Json, field: string, count: number): number[] {
  const values = list(from[field], field);
  const good =
    values.length === count && values.every((v) => typeof v === 'number' && Number.isFinite(v));
  if (!good) throw new InvalidField(`${field} must be an array of ${count} numbers`);
  return values as number[];
}

/**
 * Returns a hexadecimal color unchanged and gray for anything else, because the text is used in
 * style attributes.
 */
export function colorOf(value: unknown): string {
  return typeof value === 'string' && /^#[0-9a-fA-F]{6}$/.test(value) ? value : '#7a8699';
}

/** A missing field is false. */
export function flag(from: Json, field: string): boolean {
  return from[field] === true;
}
