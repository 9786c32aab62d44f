// SPDX-License-Identifier: Apache-2.0
// Pixels of a page. Pictures are compared only when they are still, exact and uncovered: a page draws
// with fewer pixels while its picture moves, with coarse tiles until it rests, and shows the server's
// picture in place of its own until that is there.

import { writeFile } from 'node:fs/promises';
import { nextFrames } from './browser.mjs';
import { until } from './processes.mjs';

const SHOT_MS = 120_000; // software WebGL on a busy machine
const STILL_S = 120;

/**
 * The number of the picture that a page shows; throws what it lacks if that is not a still one of
 * exact tiles, with nothing of the server's over it.
 */
async function stillNumber(page) {
  const { lacks, shown } = await page.evaluate(() => {
    const { exactTiles, pictures, snapshotComplete } = window.kerf.state();
    const poster = document.querySelector('.poster');
    const has = {
      'the whole block': snapshotComplete && window.kerf.marks.block !== undefined,
      'exact tiles': exactTiles,
      'full quality': pictures?.isStill,
      'a clear view': !poster || poster.hidden,
    };
    const names = Object.keys(has).filter((name) => !has[name]);
    return { lacks: names.join(', '), shown: pictures?.shown };
  });
  if (lacks) throw new Error(`it lacks ${lacks}`);
  return shown;
}

/** Waits until the picture is still, exact and uncovered, after what was done last. */
export async function untilStill({ page }) {
  await nextFrames(page);
  await until('still, exact and uncovered picture', STILL_S, async () => {
    await stillNumber(page);
    return true;
  });
}

/** A screenshot of such a picture: it was so before, and no other one was shown meanwhile. */
export async function stillShot({ page }) {
  await nextFrames(page);
  return until('still, exact and uncovered picture', STILL_S, async () => {
    const number = await stillNumber(page);
    const png = Buffer.from(await page.screenshot({ timeout: SHOT_MS }));
    return (await stillNumber(page)) === number && png;
  });
}

/** Pixels of a screenshot, RGBA, of the part that begins at x, y. */
async function pixelsOf(page, png, [x, y, width, height]) {
  const base64 = await page.evaluate(
    async ([coded, left, top, columns, rows]) => {
      const bytes = Uint8Array.from(atob(coded), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
      const context = new OffscreenCanvas(columns, rows).getContext('2d');
      context.drawImage(bitmap, -left, -top);
      const { data } = context.getImageData(0, 0, columns, rows);
      // As one text: a million numbers would take seconds to come.
      const parts = [];
      for (let n = 0; n < data.length; n += 32_768)
        parts.push(String.fromCharCode(...data.subarray(n, n + 32_768)));
      return btoa(parts.join(''));
    },
    [png.toString('base64'), x, y, width, height],
  );
  return Buffer.from(base64, 'base64');
}

/** The colors of pixels of a still picture: red, green, blue, 0 to 255; places are x, y. */
export async function colorsAt(viewer, places) {
  const png = await stillShot(viewer);
  const colors = [];
  for (const [x, y] of places)
    colors.push([...(await pixelsOf(viewer.page, png, [x, y, 1, 1])).subarray(0, 3)]);
  return colors;
}

/** Brightness of each pixel, 0 to 255. */
function brightnessOf(rgba) {
  const values = [];
  for (let i = 0; i < rgba.length; i += 4)
    values.push(0.299 * rgba[i] + 0.587 * rgba[i + 1] + 0.114 * rgba[i + 2]);
  return values;
}

/**
 * Number of pixels in a box of a still picture (left, top, width, height) whose red is so much
 * greater than their blue.
 */
export async function countPixels(viewer, box, { leastRedOverBlue }) {
  const rgba = await pixelsOf(viewer.page, await stillShot(viewer), box);
  let count = 0;
  for (let i = 0; i < rgba.length; i += 4)
    if (rgba[i] - rgba[i + 2] >= leastRedOverBlue) count += 1;
  return count;
}

/**
 * Mean difference of brightness, 0 to 255, of the still pictures of two pages of one size in a box:
 * left, top, right, bottom.
 */
export async function differenceOf(viewer, other, [left, top, right, bottom]) {
  const box = [left, top, right - left, bottom - top].map(Math.floor);
  const [one, two] = await Promise.all(
    [viewer, other].map(async (each) =>
      brightnessOf(await pixelsOf(each.page, await stillShot(each), box)),
    ),
  );
  return one.reduce((sum, value, n) => sum + Math.abs(value - two[n]), 0) / one.length;
}

/** Mean luminance, 0 to 1, of the middle of a box of a still picture: left, top, right, bottom. */
export async function luminanceIn(viewer, [left, top, right, bottom]) {
  const png = await stillShot(viewer);
  const width = Math.max(1, Math.floor((right - left) * 0.7));
  const height = Math.max(1, Math.floor((bottom - top) * 0.7));
  const corner = [Math.floor((left + right - width) / 2), Math.floor((top + bottom - height) / 2)];
  const values = brightnessOf(await pixelsOf(viewer.page, png, [...corner, width, height]));
  // sRGB's transfer curve, nearly.
  return values.reduce((sum, value) => sum + (value / 255) ** 2.2, 0) / values.length;
}

/**
 * Saves a screenshot, also of a picture that moves. Returns the standard deviation of the brightness
 * (0 to 255) in its middle, where the block is: of a blank picture it is about 0.
 */
export async function photograph(viewer, file) {
  const png = await viewer.page.screenshot({ timeout: SHOT_MS });
  await writeFile(file, png);
  const { width, height } = viewer.page.viewportSize();
  const middle = [0.2 * width, 0.25 * height, 0.4 * width, 0.5 * height].map(Math.floor);
  const values = brightnessOf(await pixelsOf(viewer.page, png, middle));
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  return Math.sqrt(squares / values.length);
}
