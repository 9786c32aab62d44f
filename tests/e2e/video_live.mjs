// SPDX-License-Identifier: Apache-2.0
// End-to-end test of the video in which the block turns: it is cancelled, then saved, and the browser
// plays the file. See README.md.
//
// node video_live.mjs --server PROGRAM --web FOLDER --out FOLDER

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { optionsOf, runTest, startServer } from './support/session.mjs';

const options = optionsOf(['server', 'web', 'out']);

const SETTLE_S = 120; // software WebGL on a busy machine
const SAVE_MS = 480_000;
const SECONDS = 6;
const PIXELS = 640; // where the CPU draws
const SCENE = boxScene('Turning block', [-20, -15, -10], [20, 15, 0], [cutter(1, 'flat', 4)], {
  accuracy: { pitch_mm: 1 },
});

/**
 * Reads a video in a page whose policy lets it play a file: its length and
 * size, and how much two of its frames differ.
 */
async function played(page, file) {
  const bytes = (await readFile(file)).toString('base64');
  return page.evaluate(async (base64) => {
    const data = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const video = document.createElement('video');
    video.src = URL.createObjectURL(new Blob([data], { type: 'video/mp4' }));
    const once = (name) =>
      new Promise((resolve, reject) => {
        video.addEventListener(name, resolve, { once: true });
        video.addEventListener('error', () => reject(new Error(video.error.message)));
      });
    await once('loadeddata');
    const { videoWidth: width, videoHeight: height, duration } = video;
    const context = new OffscreenCanvas(width, height).getContext('2d');
    const frameAt = async (seconds) => {
      const seeked = once('seeked');
      video.currentTime = seconds;
      await seeked;
      context.drawImage(video, 0, 0);
      return context.getImageData(0, 0, width, height).data;
    };
    const first = await frameAt(0.5);
    const later = await frameAt(duration / 6); // a sixth of a turn
    let changed = 0;
    for (let n = 0; n < first.length; n += 4) if (Math.abs(first[n] - later[n]) > 30) changed += 1;
    return { width, height, duration, changed: changed / (width * height) };
  }, bytes);
}

async function test(folder) {
  const { server, base } = await startServer(options, folder, 'turning', SCENE);
  await withBrowser(async (browser) => {
    const viewer = await openViewer(browser, `${base}/?session=turning`, {
      width: 960,
      height: 640,
    });
    const { page, state, problems } = viewer;
    await until('picture', SETTLE_S, async () => (await state())?.snapshotComplete);
    await page.getByRole('button', { name: 'Save video' }).click();
    await page.getByRole('button', { name: /Cancel video, [1-9]/ }).click();
    const save = page.getByRole('button', { name: 'Save video' });
    await save.waitFor();
    const coming = page.waitForEvent('download', { timeout: SAVE_MS });
    await save.click();
    const download = await coming;
    assert.equal(download.suggestedFilename(), 'Turning-block.mp4');
    const file = join(options.out, 'turning.mp4');
    await download.saveAs(file);
    const { width, height, duration, changed } = await played(await page.context().newPage(), file);
    console.log(`${width} × ${height}, ${duration} s, ${(100 * changed).toFixed(1)} % changed`);
    assert.equal(Math.max(width, height), PIXELS);
    assert(Math.abs(duration - SECONDS) < 0.2, `${duration} s`);
    assert(changed > 0.02, 'the block does not turn');
    await save.waitFor();
    assert.deepEqual(problems, []);
  });
  assert.equal(await stop(server), 0, `the server exited with an error: ${server.errors}`);
}

await runTest(test, options.out);
