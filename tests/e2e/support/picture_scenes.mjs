// SPDX-License-Identifier: Apache-2.0
// Ten carved blocks whose pictures are hard to draw with fewer triangles: thin ridges, scallops,
// undercuts, small text, shallow grooves, rims and steps.

const HEAD = ['G21 G90', 'T1 M6', 'S10000 M3', 'G0 Z5'];
const END = ['G0 Z5', 'M30', ''];

/** The lines that cut along points [x, y, z]: there above the block, then down and along. */
function cut(points) {
  const [first, ...rest] = points;
  const to = ([x, y, z]) => `X${x.toFixed(4)} Y${y.toFixed(4)} Z${z.toFixed(4)}`;
  return [
    `G0 X${first[0].toFixed(4)} Y${first[1].toFixed(4)}`,
    `G1 ${to(first)} F2000`,
    ...rest.map((point) => `G1 ${to(point)}`),
    'G0 Z5',
  ];
}

const range = (count) => Array.from({ length: count }, (_, n) => n);

/** Rows over the whole block, whose height is a function of the place. */
function rows(step, height) {
  const paths = range(Math.floor(60 / step) + 1).map((n) =>
    range(121).map((k) => [k / 2, n * step, height(k / 2, n * step)]),
  );
  return paths.flatMap((path, n) => cut(n % 2 === 0 ? path : path.reverse()));
}

function circle(x, y, radius, z) {
  return range(73).map((n) => {
    const angle = (n * Math.PI) / 36;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle), z];
  });
}

/** Strokes of the letters, on a grid of 4 × 6. */
const LETTERS = {
  K: ['00 06', '46 03 40'],
  E: ['46 06 00 40', '03 33'],
  R: ['00 06 36 45 44 33 03', '33 40'],
  F: ['46 06 00', '03 33'],
  2: ['05 16 36 45 44 00 40'],
  0: ['00 06 46 40 00'],
  4: ['46 02 42', '30 34'],
};

function text(words, x, y, size, z) {
  return [...words].flatMap((letter, n) =>
    (LETTERS[letter] ?? []).flatMap((stroke) =>
      cut(
        stroke
          .split(' ')
          .map(([column, row]) => [
            x + n * 5.5 * size + Number(column) * size,
            y + Number(row) * size,
            z,
          ]),
      ),
    ),
  );
}

const ball = (diameter_mm) => ({
  id: 1,
  shape: 'ball',
  diameter_mm,
  length_mm: 30,
});
const flat = (diameter_mm) => ({
  id: 1,
  shape: 'flat',
  diameter_mm,
  length_mm: 30,
});
/** A disk of 10 mm, 2 mm thick, below a neck of 4 mm. */
const SLOT = {
  id: 1,
  shape: 'profile',
  profile_mm: [
    [0, 0],
    [5, 0],
    [5, 2],
    [2, 2],
    [2, 30],
  ],
};

function scene(name, tool, lines, { rays = 'dexel', pitch_mm = 0.25 } = {}) {
  return {
    name,
    scene: {
      name,
      stock: { shape: 'box', min_mm: [0, 0, -12], max_mm: [60, 60, 0] },
      accuracy: { rays, pitch_mm, tolerance_mm: 0.01, motion: 'tight' },
      tools: [tool],
    },
    program: [...HEAD, ...lines, ...END].join('\n'),
  };
}

export const PICTURE_SCENES = [
  scene(
    'scallops',
    ball(6),
    rows(1.1, (x, y) => -3 + Math.sin(x / 6) * Math.cos(y / 9)),
  ),
  scene(
    'fine scallops',
    ball(10),
    rows(0.7, (x, y) => -2 - 3 * Math.exp(-((x - 30) ** 2 + (y - 30) ** 2) / 200)),
  ),
  scene(
    'thin ridges',
    flat(3),
    range(17).flatMap((n) =>
      cut([
        [-3, 2 + 3.4 * n, -4],
        [63, 3.5 + 3.4 * n, -4],
      ]),
    ),
  ),
  scene(
    'shallow grooves',
    ball(2),
    range(24).flatMap((n) => {
      const angle = ((n + 0.13) * Math.PI) / 12;
      const at = (r) => [30 + r * Math.cos(angle), 30 + r * Math.sin(angle), -0.3];
      return cut([at(6), at(28)]);
    }),
  ),
  scene('small text', ball(0.8), [
    ...text('KERF2004', 6, 44, 1.1, -0.4),
    ...text('FREE2004', 6, 30, 0.7, -0.3),
    ...text('KERF', 12, 12, 1.6, -0.6),
  ]),
  scene(
    'rims',
    flat(4),
    range(9).flatMap((n) =>
      cut(circle(10 + 20 * (n % 3), 10 + 20 * Math.floor(n / 3), 5.3, -1 - n)),
    ),
  ),
  scene(
    'steps',
    flat(8),
    range(12).flatMap((n) =>
      cut([
        [30 - 26 + 2 * n, -6, -1 - 0.8 * n],
        [34 + 2 * n, 66, -1 - 0.8 * n],
      ]),
    ),
  ),
  scene(
    'undercuts',
    SLOT,
    range(3).flatMap((n) =>
      cut([
        [-8, 12 + 18 * n, -7],
        [68, 12 + 18 * n, -7],
      ]),
    ),
    { rays: 'tri-dexel', pitch_mm: 0.4 },
  ),
  scene(
    'walls',
    flat(6),
    range(6).flatMap((n) => cut(circle(30, 30, 8 + 3.2 * n, -2 - 1.5 * n))),
    { rays: 'tri-dexel', pitch_mm: 0.4 },
  ),
  scene(
    'cross hatch',
    ball(3),
    range(20).flatMap((n) => [
      ...cut([
        [-2, 3 * n, -0.5],
        [62, 3 * n + 2, -0.5],
      ]),
      ...cut([
        [3 * n, -2, -0.6],
        [3 * n + 5, 62, -0.6],
      ]),
    ]),
  ),
];
