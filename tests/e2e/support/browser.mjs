// SPDX-License-Identifier: Apache-2.0
// Headless Chromium with software WebGL; state and screenshots of a viewer page.

import { writeFile } from 'node:fs/promises';
import { chromium } from 'playwright-core';

const ARGS = [
  '--no-sandbox',
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-background-networking',
  '--disable-quic',
  '--no-first-run',
];

export function launchBrowser() {
  return chromium.launch({
    executablePath: process.env.KERF_CHROMIUM ?? '/usr/bin/chromium',
    args: ARGS,
  });
}

/**
 * Opens a viewer in its own browser context. `problems` collects the page's exceptions and console
 * errors.
 */
export async function openViewer(browser, url, viewport) {
  const context = await browser.newContext({ viewport, ignoreHTTPSErrors: true });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  const problems = [];
  page.on('pageerror', (problem) => problems.push(problem.message));
  page.on('console', (message) => {
    if (message.type() === 'error') problems.push(message.text());
  });
  await page.goto(url);
  return { page, problems, state: () => page.evaluate(() => window.kerf?.state()) };
}

/**
 * Saves a screenshot. Returns the standard deviation of the brightness (0 to 255) in its middle,
 * where the block is.
 */
export async function photograph(viewer, file) {
  const png = await viewer.page.screenshot({ timeout: 120_000 });
  await writeFile(file, png);
  return viewer.page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const [width, height] = [Math.floor(bitmap.width * 0.4), Math.floor(bitmap.height * 0.5)];
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext('2d');
    context.drawImage(bitmap, -bitmap.width * 0.2, -bitmap.height * 0.25);
    const { data } = context.getImageData(0, 0, width, height);
    let sum = 0;
    let squares = 0;
    for (let i = 0; i < data.length; i += 4) {
      const brightness = 0.299 * data[i] + 0.587 * data[i + 1] + 0.114 * data[i + 2];
      sum += brightness;
      squares += brightness * brightness;
    }
    const count = data.length / 4;
    return Math.sqrt(Math.max(0, squares / count - (sum / count) ** 2));
  }, png.toString('base64'));
}
