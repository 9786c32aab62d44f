// SPDX-License-Identifier: Apache-2.0
// The manual: its links lead somewhere, and the options that it names exist.
import { readdirSync, readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { anchorOf, PAGES, renderManual, sourceOf } from '../manual/render';

const ROOT = new URL('../../', import.meta.url);
const FILES = renderManual();
const HTML = [...FILES].filter(([name]) => name.endsWith('.html'));

const idsOf = (html: string): Set<string> =>
  new Set([...html.matchAll(/ id="([^"]+)"/g)].map((match) => match[1]!));

/** The sources of a program that state its options. */
const HELP: Readonly<Record<string, readonly string[]>> = {
  'kerf-server': ['server'],
  'kerf-agent': ['haptic_agent', 'haptic_agent/doctor'],
  'kerf-carve': ['server/carve'],
  'kerf-haply': ['haptic_agent/haply'],
  './run.sh': ['.'],
};

function optionsIn(folders: readonly string[]): Set<string> {
  const options = new Set(['--help', '--version']);
  for (const folder of folders) {
    for (const file of readdirSync(new URL(`${folder}/`, ROOT))) {
      if (!/\.(cpp|py)$|^run\.sh$/.test(file)) continue;
      const text = readFileSync(new URL(`${folder}/${file}`, ROOT), 'utf8');
      const stated = file === 'run.sh' ? /^ {2}(--[a-z-]+)/gm : /"(--[a-z0-9][a-z0-9-]*)/g;
      for (const [, option] of text.matchAll(stated)) options.add(option!);
      // An option for each format of models.
      for (const [, format] of text.matchAll(/\{ModelFormat::k(\w+), "write/g))
        options.add(`--${format!.toLowerCase()}`);
    }
  }
  return options;
}

const KNOWN = Object.fromEntries(
  Object.entries(HELP).map(([program, folders]) => [program, optionsIn(folders)]),
);

const COMMAND = /^(?:[A-Z_]+=\S+ )*(?:build\/release\/bin\/)?(kerf-[a-z]+|\.\/run\.sh|--)/;

/** The options of a command, or an option by itself, each with the options that there are. */
function optionsOf(code: string): [string, readonly Set<string>[]][] {
  const program = COMMAND.exec(code)?.[1];
  if (program === undefined) return [];
  const known = program === '--' ? Object.values(KNOWN) : [KNOWN[program]!];
  return [...code.matchAll(/(?<![\w-])--[a-z0-9][a-z0-9-]*/g)].map(([option]) => [option, known]);
}

describe('the manual', () => {
  it('has a page for each Markdown file, and nothing that runs or is fetched', () => {
    const sources = readdirSync(new URL('web/manual/', ROOT)).filter((file) =>
      file.endsWith('.md'),
    );
    expect(sources.sort()).toEqual(PAGES.map((name) => `${name}.md`).sort());
    for (const [, html] of HTML) {
      expect(html).toMatch(/<h1 id=/);
      expect(html).not.toMatch(/<script|\sstyle=|(?:href|src)="(?:\/|https?:)/);
    }
  });

  it('has links to pages and headings that exist', () => {
    let links = 0;
    for (const [name, html] of HTML) {
      for (const [, href] of html.matchAll(/(?:href|src)="([^"]+)"/g)) {
        if (href === '../icon.svg') continue;
        const [file, anchor] = href!.split('#');
        const target = file === '' ? html : FILES.get(file!);
        expect(target, `${name}: ${href}`).toBeDefined();
        if (anchor !== undefined) expect(idsOf(target!), `${name}: ${href}`).toContain(anchor);
        ++links;
      }
    }
    expect(links).toBeGreaterThan(80);
  });

  it('has headings whose anchors differ', () => {
    for (const [name, html] of HTML) {
      const ids = [...html.matchAll(/ id="/g)].length;
      expect(idsOf(html).size, name).toBe(ids);
    }
    expect(anchorOf('Who may do what?')).toBe('who-may-do-what');
  });

  it('names options that the programs have', () => {
    let options = 0;
    for (const page of PAGES) {
      for (const line of sourceOf(page).split('\n')) {
        const spans = [...line.matchAll(/`([^`]+)`/g)].map(([, code]) => code!);
        for (const [option, known] of [line, ...spans].flatMap(optionsOf)) {
          const exists = known.some((of) => of.has(option));
          expect(exists, `${page}.md: ${option} in ${line}`).toBe(true);
          ++options;
        }
      }
    }
    expect(options).toBeGreaterThan(80);
  });
});
