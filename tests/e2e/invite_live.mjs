// SPDX-License-Identifier: Apache-2.0
// An owner invites a watcher in the page: the real server with TLS and rights, and two browsers. See
// README.md.
//
// node invite_live.mjs --server PROGRAM --web FOLDER

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { request } from 'node:https';
import { join } from 'node:path';
import { openViewer, withBrowser } from './support/browser.mjs';
import { run, start, stop, until } from './support/processes.mjs';
import { boxScene, cutter } from './support/scene.mjs';
import { optionsOf, runTest } from './support/session.mjs';

const options = optionsOf(['server', 'web']);

const SETTLE_S = 90; // software WebGL on a busy machine
const SCENE = boxScene('invitation', [-10, -10, -10], [10, 10, 0], [cutter(1, 'ball', 6)], {
  accuracy: { pitch_mm: 1 },
});

/** Sends a request over TLS, with the server's own certificate as the authority. */
function ask(url, { method = 'GET', token, body, ca }) {
  return new Promise((resolve, reject) => {
    const headers = { Authorization: `Bearer ${token}` };
    const sent = request(url, { method, ca, headers }, (response) => {
      let text = '';
      response.on('data', (data) => (text += data));
      response.on('end', () => resolve({ status: response.statusCode, json: JSON.parse(text) }));
    });
    sent.on('error', reject);
    sent.end(body);
  });
}

async function startServer(folder) {
  const [certificate, key] = [join(folder, 'chain.pem'), join(folder, 'key.pem')];
  await run('openssl', [
    ...['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes'],
    ...['-keyout', key, '-out', certificate, '-days', '2', '-subj', '/CN=127.0.0.1'],
    ...['-addext', 'subjectAltName=IP:127.0.0.1'],
  ]);
  const admin = join(folder, 'admin');
  const server = start(options.server, [
    ...['--listen', '127.0.0.1:0', '--data', join(folder, 'data'), '--web', options.web],
    ...['--tls-cert', certificate, '--tls-key', key, '--admin-token-file', admin],
  ]);
  const base = await until('server address', 20, () => {
    assert.equal(server.code, undefined, `the server exited: ${server.errors}`);
    return server.lines.find((line) => line.startsWith('https'));
  });
  const token = (await readFile(admin, 'ascii')).trim();
  const api = (method, path, body) =>
    readFile(certificate).then((ca) => ask(base + path, { method, token, body, ca }));
  const created = await api('POST', '/v1/sessions?id=e2e', JSON.stringify(SCENE));
  assert.equal(created.status, 201, JSON.stringify(created.json));
  return { server, base, api };
}

/** The owner makes a link for watchers in the dialog. Returns it. */
async function invite(page) {
  await page.getByRole('button', { name: 'Share' }).click();
  const dialog = page.getByRole('dialog', { name: 'Invite' });
  await dialog.getByText('Watcher', { exact: true }).click();
  await dialog.getByRole('button', { name: 'Create link' }).click();
  const field = dialog.getByLabel('Invitation link', { exact: true });
  await field.waitFor();
  const link = await field.inputValue();
  await dialog.getByRole('img', { name: 'QR code' }).locator('svg').waitFor();
  await dialog.getByRole('button', { name: 'Close' }).click();
  return link;
}

async function open(browser, link) {
  const viewer = await openViewer(browser, link, { width: 1000, height: 600 });
  await until('complete block', SETTLE_S, async () => (await viewer.state())?.snapshotComplete);
  // The token is in a cookie now, which no script can read, and not in the address.
  assert(!viewer.page.url().includes('invite='), viewer.page.url());
  const cookies = await viewer.page.context().cookies(`${new URL(link).origin}/v1/sessions/e2e`);
  assert.equal(cookies.length, 1);
  assert.deepEqual([cookies[0].secure, cookies[0].httpOnly], [true, true]);
  assert.equal(await viewer.page.evaluate('document.cookie'), '');
  return viewer;
}

async function test(folder) {
  const { server, base, api } = await startServer(folder);
  await withBrowser(async (browser) => {
    const first = await api('POST', '/v1/sessions/e2e/invitations?role=owner');
    const owner = await open(browser, base + first.json.link);
    const link = await invite(owner.page);
    assert(link.startsWith(`${base}/?session=e2e#invite=kerf_`), link);
    const watcher = await open(browser, link);
    const button = watcher.page.getByRole('button', { name: 'Share' });
    assert.equal(await button.isVisible(), false, 'a watcher invites nobody');
    const { json } = await api('GET', '/v1/sessions/e2e');
    const roles = json.participants.map((participant) => participant.role).sort();
    assert.deepEqual(roles, ['owner', 'watcher']);
    assert.deepEqual([...owner.problems, ...watcher.problems], []);
  });
  assert.equal(await stop(server), 0, server.errors);
  console.log('an owner has invited a watcher over TLS');
}

await runTest(test);
