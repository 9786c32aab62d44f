// SPDX-License-Identifier: Apache-2.0
// Debian's Firefox, on a display of its own: without one it has no WebGL. It is driven by WebDriver
// BiDi, which the Firefox that Debian ships understands, unlike the protocol of playwright-core.

import puppeteer from 'puppeteer-core';
import { goTo, START_MS } from './browser.mjs';
import { keepPages } from './kept.mjs';
import { start, stop, until } from './processes.mjs';

const PREFERENCES = {
  'ui.prefersReducedMotion': 1, // views are there at once
  'webgl.force-enabled': true,
};

/** Starts a display, which chooses its number. */
async function startDisplay() {
  const display = start('Xvfb', [
    ...['-displayfd', '1', '-screen', '0', '1600x1200x24', '-nolisten', 'tcp'],
  ]);
  const number = await until('display', 20, () => {
    if (display.code !== undefined) throw new Error(`Xvfb exited: ${display.errors}`);
    return display.lines[0];
  });
  return { display, name: `:${number}` };
}

/** Calls `use` with a browser and closes it; if that fails, the pages are kept as they were. */
export async function withFirefox(use) {
  const { display, name } = await startDisplay();
  const browser = await puppeteer.launch({
    browser: 'firefox',
    executablePath: process.env.KERF_FIREFOX ?? '/usr/bin/firefox-esr',
    headless: false,
    timeout: START_MS,
    env: { ...process.env, DISPLAY: name },
    extraPrefsFirefox: PREFERENCES,
  });
  try {
    await use(browser);
  } catch (problem) {
    const pages = await Promise.all(browser.browserContexts().map((context) => context.pages()));
    await keepPages(pages.flat());
    throw problem;
  } finally {
    await browser.close();
    await stop(display);
  }
}

/** As openViewer of browser.mjs; `viewport` is Puppeteer's, which has touch and a scale. */
export async function openInFirefox(browser, url, viewport) {
  const context = await browser.createBrowserContext();
  const page = await context.newPage();
  await page.setViewport(viewport);
  return { ...(await goTo(page, url)), close: () => context.close() };
}
