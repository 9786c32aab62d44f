// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from 'vitest';
import { pictureUrl, PictureVersions } from '../src/link/picture_url';
import { takeHome } from '../src/link/take_home';
import type { Progress } from '../src/link/take_home';
import { choicesFor, fileOf, GROUPS, lossesIn, nameIn, sizeOf } from '../src/model/take_home';

const all = GROUPS.flatMap(({ formats }) => formats);
const format = (name: string): (typeof all)[number] => all.find((one) => one.name === name)!;

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

test('the choices of a format are parameters of the server', () => {
  const of = (name: string): string[] =>
    choicesFor(format(name).detail).map((choice) => fileOf(format(name), choice));
  expect(of('STL').slice(0, 2)).toEqual(['model.stl', 'model.stl?error_mm=0']);
  expect(of('STL')).toContain('model.stl?triangles=100000');
  expect(of('GLB compressed')).toContain('model.glb?encoding=meshopt&error_mm=0.05');
  expect(of('NC')).toContain('program.ngc?tolerance_mm=0.01');
  expect(of('CSV')).toEqual(['forces.csv']);
});

test('a size follows what the session has, and the choice', () => {
  const [part, exact, million] = choicesFor('surface');
  const amounts = { motions: 1000, columns: 1_000_000 };
  const stl = format('STL');
  expect(sizeOf(stl, exact!, amounts)! / 120e6).toBeCloseTo(1, 2);
  expect(sizeOf(stl, million!, amounts)! / 50e6).toBeCloseTo(1, 2);
  expect(sizeOf(stl, part!, amounts)).toBe(2 ** 26); // the largest part that a server accepts
  expect(sizeOf(stl, part!, { motions: 0, columns: 1000 })).toBeLessThan(130_000);
  // A small block has fewer triangles than are allowed.
  expect(sizeOf(stl, million!, { motions: 0, columns: 1000 })).toBeLessThan(130_000);
  expect(sizeOf(format('NC'), exact!, amounts)! / 82e3).toBeCloseTo(1, 2);
});

test('the name of a file is the one that the server sends', () => {
  expect(nameIn('attachment; filename="a.stl"')).toBe('a.stl');
  expect(nameIn('attachment; filename="_.stl"; filename*=UTF-8\'\'%C3%A4.stl')).toBe('ä.stl');
  expect(nameIn('attachment; filename="_.stl"; filename*=UTF-8\'\'%')).toBe('_.stl');
  expect(nameIn('')).toBe('');
});

test('a surface says what it has lost', () => {
  expect(lossesIn('')).toEqual([]);
  expect(lossesIn('{"triangles":9}')).toEqual([]);
  expect(lossesIn('{"triangles":9,"collapsed_triangles":3}')).toEqual([]);
  const far = '{"triangles":9,"collapsed_triangles":3,"warning":"3 of 9 triangles have no area"}';
  expect(lossesIn(far)).toEqual([
    'The model is so far from the origin that some of it is lost (3).',
  ]);
});

function answer(parts: string[], headers: Record<string, string>): Response {
  const bytes = parts.map((part) => new TextEncoder().encode(part));
  const body = new ReadableStream<Uint8Array>({
    pull: (controller) => {
      const next = bytes.shift();
      if (next) controller.enqueue(next);
      else controller.close();
    },
  });
  return new Response(body, { headers });
}

test('progress is that of the server, then of the line', async () => {
  vi.useFakeTimers();
  let send: (response: Response) => void = () => undefined;
  const exports = {
    exports: [
      { name: 'forces.csv', share: 0.9 },
      { name: 'model.stl', share: 0.25 },
    ],
  };
  let asked = 0;
  vi.stubGlobal('fetch', (address: string) => {
    if (!address.endsWith('/exports')) return new Promise<Response>((resolve) => (send = resolve));
    asked += 1;
    return Promise.resolve(Response.json(exports));
  });
  const seen: Progress[] = [];
  const taken = takeHome('a b', 'model.stl?triangles=9', new AbortController().signal, (one) =>
    seen.push(one),
  );
  await vi.advanceTimersByTimeAsync(900);
  expect(seen.at(-1)).toEqual({ phase: 'making', share: 0.25, bytes: 0 });
  send(
    answer(['abc', 'def'], {
      'content-length': '12',
      'content-disposition': 'attachment; filename="Part.stl"',
      'kerf-model': '{"triangles":9,"exact_triangles":99,"within_mm":0.0125}',
    }),
  );
  const { name, content, losses } = await taken;
  expect(losses).toEqual(['Its surface is within 0.013 mm of the block.']);
  expect(name).toBe('Part.stl');
  expect(await content.text()).toBe('abcdef');
  expect(seen.slice(-2)).toEqual([
    { phase: 'coming', share: 0.25, bytes: 3 },
    { phase: 'coming', share: 0.5, bytes: 6 },
  ]);
  const before = [seen.length, asked];
  await vi.advanceTimersByTimeAsync(2000);
  expect([seen.length, asked]).toEqual(before);
});

test('an error of the server is a sentence, and cancelling is none', async () => {
  const fails = (response: () => Promise<Response>): Promise<unknown> => {
    vi.stubGlobal('fetch', response);
    return takeHome('s', 'model.stl', new AbortController().signal, () => undefined);
  };
  const body = { error: { code: 'budget_impossible', reason: 'too few triangles' } };
  await expect(fails(() => Promise.resolve(Response.json(body, { status: 422 })))).rejects.toThrow(
    'too few triangles',
  );
  await expect(fails(() => Promise.reject(new TypeError('x')))).rejects.toThrow('did not answer');
  const cancelled = new AbortController();
  vi.stubGlobal('fetch', (_: string, { signal }: RequestInit) => {
    cancelled.abort();
    return Promise.reject(signal!.reason as Error);
  });
  await expect(takeHome('s', 'a', cancelled.signal, () => undefined)).rejects.toHaveProperty(
    'name',
    'AbortError',
  );
});

test('a picture is asked for after each change and once at rest', () => {
  const versions = new PictureVersions();
  expect([0, 0, 0, 5, 6, 6, 6].map((motions) => versions.next(motions, 2 * motions))).toEqual([
    '0-0',
    '0-0-at-rest',
    null,
    '5-10',
    '6-12',
    '6-12-at-rest',
    null,
  ]);
  expect(versions.next(6, 4)).toBe('6-4'); // an undo
  expect(versions.next(6, 12)).toBe('6-12'); // and a redo
  expect(pictureUrl('a/b', '5', 480)).toBe('/v1/sessions/a%2Fb/picture.png?width=480&version=5');
});
