// SPDX-License-Identifier: Apache-2.0
// Runs the type checker, the linter and the formatter over the whole folder; their findings fail the
// tests.
import { execFile } from 'node:child_process';
import { describe, expect, it } from 'vitest';

/** Runs a script of package.json. Returns its exit code and, if it failed, its output. */
function runScript(name: string): Promise<{ code: number; output: string }> {
  return new Promise((resolve) => {
    const cwd = new URL('..', import.meta.url);
    execFile('npm', ['run', '--silent', name], { cwd }, (error, stdout, stderr) => {
      resolve(
        error ? { code: Number(error.code), output: stdout + stderr } : { code: 0, output: '' },
      );
    });
  });
}

describe.concurrent('style', () => {
  it.each(['check', 'lint', 'format:check'])(
    'npm run %s finds nothing',
    { timeout: 240_000 },
    async (script) => {
      expect(await runScript(script)).toEqual({ code: 0, output: '' });
    },
  );
});
