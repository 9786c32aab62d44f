// SPDX-License-Identifier: Apache-2.0
// Files that can be taken home: for what, in which detail, and about how large they are.

import { language, t } from '../strings';

export type Detail = 'surface' | 'motions' | 'none';

export interface TakeHomeFormat {
  name: string;
  text: string;
  /** Below /v1/sessions/{id}/. */
  file: string;
  detail: Detail;
  /** Bytes of a triangle or a motion; null: not known. */
  bytesEach: number | null;
}

export interface TakeHomeGroup {
  title: string;
  formats: readonly TakeHomeFormat[];
}

function surface(name: string, file: string, text: string, bytesEach: number): TakeHomeFormat {
  return { name, file, text, detail: 'surface', bytesEach };
}

// Sizes: of a milled plate with 2 million triangles, and of journals of hands.
export const GROUPS: readonly TakeHomeGroup[] = [
  {
    title: t('Print'),
    formats: [
      surface('3MF', 'model.3mf', t('Closed surface, in millimeters'), 14),
      surface('STL', 'model.stl', t('Closed surface'), 50),
      surface(
        t('STL text'),
        'model.stl?encoding=ascii',
        t("For programs that can't read binary STL"),
        184,
      ),
    ],
  },
  {
    title: 'CAM',
    formats: [
      {
        name: 'NC',
        file: 'program.ngc',
        text: t('Every cut as G-code'),
        detail: 'motions',
        bytesEach: 82,
      },
      {
        name: 'APT',
        file: 'program.apt',
        text: t('Every cut as tool positions'),
        detail: 'motions',
        bytesEach: 82,
      },
    ],
  },
  {
    title: 'CAD',
    formats: [
      surface('OBJ', 'model.obj', t('For modeling programs'), 84),
      surface('PLY', 'model.ply', t('For mesh editors'), 19),
    ],
  },
  {
    title: t('Web'),
    formats: [
      surface('GLB', 'model.glb', t('For 3D viewers and AR'), 20),
      surface(
        t('GLB quantized'),
        'model.glb?encoding=quantized',
        t('Smaller, for most viewers'),
        13,
      ),
      surface(
        t('GLB compressed'),
        'model.glb?encoding=meshopt',
        t('Smallest, for viewers with meshopt'),
        4,
      ),
    ],
  },
  {
    title: t('Data'),
    formats: [
      {
        name: 'CSV',
        file: 'forces.csv',
        text: t('Force and torque over time'),
        detail: 'none',
        bytesEach: 163,
      },
    ],
  },
];

export interface DetailChoice {
  text: string;
  query: string;
  /** The most triangles; null: no limit. */
  triangles: number | null;
  /** The most bytes; null: no limit. */
  bytes: number | null;
}

/** Largest part that a server accepts, in bytes. */
const PART_BYTES_MAX = 2 ** 26;
const NO_LIMITS = { triangles: null, bytes: null };
const EXACT: DetailChoice = { text: t('full detail'), query: '', ...NO_LIMITS };

export function choicesFor(detail: Detail): readonly DetailChoice[] {
  switch (detail) {
    case 'surface':
      return [
        { text: t('up to 64 MB'), query: '', triangles: null, bytes: PART_BYTES_MAX },
        { ...EXACT, query: 'error_mm=0' },
        ...[1_000_000, 100_000, 20_000].map((triangles) => ({
          text: t('up to {0} triangles', new Intl.NumberFormat(language).format(triangles)),
          query: `triangles=${triangles}`,
          triangles,
          bytes: null,
        })),
        ...[0.01, 0.05, 0.2].map((error) => ({
          text: t('accurate to {0} mm', error),
          query: `error_mm=${error}`,
          ...NO_LIMITS,
        })),
      ];
    case 'motions':
      return [
        EXACT,
        ...[0.001, 0.01, 0.1].map((tolerance) => ({
          text: t('simplified to {0} mm', tolerance),
          query: `tolerance_mm=${tolerance}`,
          ...NO_LIMITS,
        })),
      ];
    case 'none':
      return [EXACT];
  }
}

export function fileOf({ file }: TakeHomeFormat, { query }: DetailChoice): string {
  if (query === '') return file;
  return `${file}${file.includes('?') ? '&' : '?'}${query}`;
}

/** The data of a session from which files are made. */
export interface Amounts {
  motions: number;
  /** Of the field along Z. */
  columns: number;
}

const TRIANGLES_PER_COLUMN = 2.4;
const HEAD_BYTES = 100;

/** About how large a file is at most, in bytes; null if its size is not known. */
export function sizeOf(
  format: TakeHomeFormat,
  choice: DetailChoice,
  { motions, columns }: Amounts,
): number | null {
  if (format.bytesEach === null) return null;
  const triangles = Math.min(choice.triangles ?? Infinity, TRIANGLES_PER_COLUMN * columns);
  const count = format.detail === 'surface' ? triangles : motions;
  return Math.min(choice.bytes ?? Infinity, HEAD_BYTES + count * format.bytesEach);
}

/** The losses of a surface that the header Kerf-Model states, a sentence each. */
export function lossesIn(header: string): string[] {
  let model: { exact_triangles?: unknown; within_mm?: unknown; collapsed_triangles?: unknown };
  try {
    model = JSON.parse(header) as typeof model;
  } catch {
    return [];
  }
  const { exact_triangles: exact, within_mm: within, collapsed_triangles: collapsed } = model;
  const number = new Intl.NumberFormat(language, { maximumSignificantDigits: 2 });
  const losses: string[] = [];
  if (typeof exact === 'number' && typeof within === 'number') {
    losses.push(t('Its surface is within {0} mm of the block.', number.format(within)));
  }
  if ('warning' in model && typeof collapsed === 'number') {
    losses.push(t('The model is so far from the origin that some of it is lost ({0}).', collapsed));
  }
  return losses;
}

/** The name in a Content-Disposition header, that in UTF-8 first; empty if there is none. */
export function nameIn(disposition: string): string {
  const coded = /filename\*=UTF-8''([^;]+)/i.exec(disposition)?.[1];
  if (coded !== undefined) {
    try {
      return decodeURIComponent(coded);
    } catch {
      // The plain name remains.
    }
  }
  return /filename="([^"]*)"/i.exec(disposition)?.[1] ?? '';
}
