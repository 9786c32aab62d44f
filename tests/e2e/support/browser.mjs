// SPDX-License-Identifier: Apache-2.0
// Headless Chromium with software WebGL, and the state of a viewer page.

import { chromium } from 'playwright-core';
import { keepPages } from './kept.mjs';

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
function launchBrowser(graphics = SOFTWARE_WEBGL, others = {}) {
  return chromium.launch({
    timeout: START_MS,
    ...others,
    executablePath: process.env.KERF_CHROMIUM ?? '/usr/bin/chromium',
    args: [...ARGS, ...graphics],
  });
}

/** Calls `use` with such a browser and closes it; if that fails, the pages are kept as they were. */
export async function withBrowser(use, graphics, others) {
  const browser = await launchBrowser(graphics, others);
  try {
    await use(browser);
  } catch (problem) {
    await keepPages(browser.contexts().flatMap((context) => context.pages()));
    throw problem;
  } finally {
    await browser.close();
  }
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
