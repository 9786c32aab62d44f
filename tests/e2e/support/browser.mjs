// SPDX-License-Identifier: Apache-2.0
// Headless Chromium with software WebGL; state and screenshots of a viewer page.

import { writeFile } from 'node:fs/promises';
import { chromium } from 'playwright-core';

// As Chromium does without a GPU: SwiftShader draws WebGL, the page is put together by the CPU.
const SOFTWARE_WEBGL = ['--use-angle=swiftshader-webgl', '--enable-unsafe-swiftshader'];
/** A busy machine loads a browser slowly. */
export const START_MS = 120_000;
const ARGS = [
  '--no-sandbox',
  '--disable-background-networking',
  '--disable-quic',
  '--no-first-run',
];

/** `graphics`: what the browser draws with; `others` are further options of Playwright. */
export function launchBrowser(graphics = SOFTWARE_WEBGL, others = {}) {
  return chromium.launch({
    timeout: START_MS,
    ...others,
    executablePath: process.env.KERF_CHROMIUM ?? '/usr/bin/chromium',
    args: [...ARGS, ...graphics],
  });
}

/**
 * Opens a viewer in its own browser context; `others` are further options of that, and `script` runs
 * before the page's own. `problems` collects the page's exceptions and console errors.
 */
export async function openViewer(browser, url, viewport, { script, ...others } = {}) {
  const context = await browser.newContext({
    viewport,
    ignoreHTTPSErrors: true,
    ...others,
  });
  if (script) await context.addInitScript(script);
  return goTo(await context.newPage(), url);
}

/** Opens a viewer in an empty page, of Playwright or of Puppeteer. */
export async function goTo(page, url) {
  page.setDefaultTimeout(120_000);
  const problems = [];
  page.on('pageerror', (problem) => problems.push(problem.message));
  page.on('console', (message) => {
    if (message.type() === 'error') problems.push(message.text());
  });
  await page.goto(url);
  return {
    page,
    problems,
    state: () => page.evaluate(() => window.kerf?.state()),
  };
}

/**
 * Waits until a picture is shown that was begun after this call, or what is shown is up to date: in
 * two frames, because a page that was drawing notes at its next frame what that picture lacks.
 */
export function nextFrames(page) {
  return page.evaluate(async () => {
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    const pictures = () => window.kerf?.state().pictures;
    await frame();
    const { begun } = pictures() ?? { begun: 0 };
    let upToDate = 0;
    while (upToDate < 2) {
      const now = pictures();
      if (!now || now.shown > begun) break;
      upToDate = now.isLast ? upToDate + 1 : 0;
      await frame();
    }
    await frame();
  });
}

/** Pixels of a screenshot, RGBA, of the part that begins at x, y. */
async function pixelsOf(page, png, [x, y, width, height]) {
  return page.evaluate(
    async ([base64, left, top, columns, rows]) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
      const context = new OffscreenCanvas(columns, rows).getContext('2d');
      context.drawImage(bitmap, -left, -top);
      return Array.from(context.getImageData(0, 0, columns, rows).data);
    },
    [png.toString('base64'), x, y, width, height],
  );
}

/** The color of a pixel of the page: red, green, blue, 0 to 255. */
export async function colorAt(page, x, y) {
  const png = await page.screenshot({ timeout: 120_000 });
  return (await pixelsOf(page, png, [x, y, 1, 1])).slice(0, 3);
}

/** Brightness of each pixel, 0 to 255. */
function brightnessOf(rgba) {
  const values = [];
  for (let i = 0; i < rgba.length; i += 4)
    values.push(0.299 * rgba[i] + 0.587 * rgba[i + 1] + 0.114 * rgba[i + 2]);
  return values;
}

/** Number of pixels in a box of the page (left, top, width, height) whose red is so much greater than their blue. */
export async function countPixels(page, box, { leastRedOverBlue }) {
  const png = await page.screenshot({ timeout: 120_000 });
  const rgba = await pixelsOf(page, png, box);
  let count = 0;
  for (let i = 0; i < rgba.length; i += 4)
    if (rgba[i] - rgba[i + 2] >= leastRedOverBlue) count += 1;
  return count;
}

/** Mean difference of brightness, 0 to 255, of two pages of one size in a box: left, top, right, bottom. */
export async function differenceOf(page, other, [left, top, right, bottom]) {
  const box = [left, top, right - left, bottom - top].map(Math.floor);
  const [one, two] = await Promise.all(
    [page, other].map(async (each) => {
      const png = await each.screenshot({ timeout: 120_000 });
      return brightnessOf(await pixelsOf(each, png, box));
    }),
  );
  return one.reduce((sum, value, n) => sum + Math.abs(value - two[n]), 0) / one.length;
}

/** Mean luminance, 0 to 1, of the middle of a box of the page: left, top, right, bottom. */
export async function luminanceIn(page, [left, top, right, bottom]) {
  const png = await page.screenshot({ timeout: 120_000 });
  const width = Math.max(1, Math.floor((right - left) * 0.7));
  const height = Math.max(1, Math.floor((bottom - top) * 0.7));
  const corner = [Math.floor((left + right - width) / 2), Math.floor((top + bottom - height) / 2)];
  const values = brightnessOf(await pixelsOf(page, png, [...corner, width, height]));
  // sRGB's transfer curve, nearly.
  return values.reduce((sum, value) => sum + (value / 255) ** 2.2, 0) / values.length;
}

/**
 * Saves a screenshot. Returns the standard deviation of the brightness (0 to 255) in its middle,
 * where the block is.
 */
export async function photograph(viewer, file) {
  const png = await viewer.page.screenshot({ timeout: 120_000 });
  await writeFile(file, png);
  const { width, height } = viewer.page.viewportSize();
  const middle = [0.2 * width, 0.25 * height, 0.4 * width, 0.5 * height].map(Math.floor);
  const values = brightnessOf(await pixelsOf(viewer.page, png, middle));
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  return Math.sqrt(squares / values.length);
}
