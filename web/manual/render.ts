// SPDX-License-Identifier: Apache-2.0
// Renders the Markdown files of this folder as plain HTML: no scripts, and relative links only, so
// that the pages work from a server and from a disk.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import MarkdownIt from 'markdown-it';
import type { Plugin } from 'vite';
import { operationsMarkdown, readOpenApi } from './operations';

/** The pages in the order of the navigation; each is the name of a Markdown file here. */
export const PAGES = [
  'index',
  'first-hour',
  'user',
  'operator',
  'device',
  'embedding',
  'api',
  'kerf-file',
  'decisions',
] as const;

export type PageName = (typeof PAGES)[number];

interface Heading {
  level: number;
  id: string;
  text: string;
}

interface Page {
  name: PageName;
  title: string;
  headings: Heading[];
  body: string;
}

/** The anchor of a heading, as GitHub makes it, so that links work there too. */
export function anchorOf(heading: string): string {
  return heading
    .toLowerCase()
    .replace(/[^\p{L}\p{N}\s_-]/gu, '')
    .trim()
    .replace(/\s/g, '-');
}

const markdown = new MarkdownIt({ html: false, typographer: false });

// Wide tables scroll by themselves, so that the page does not.
markdown.renderer.rules['table_open'] = () => '<div class="wide" tabindex="0"><table>\n';
markdown.renderer.rules['table_close'] = () => '</table></div>\n';

// A line does not end at the hyphens of an option.
markdown.renderer.rules['code_inline'] = (tokens, i) => {
  const code = markdown.utils.escapeHtml(tokens[i]!.content);
  return `<code>${code.replace(/--[a-z0-9-]+/g, '<span>$&</span>')}</code>`;
};

const fileText = (name: string): string => readFileSync(join(import.meta.dirname, name), 'utf8');

/**
 * The Markdown of a page. That of the HTTP interface ends with its generated reference, that of
 * the .kerf file with a program that reads it.
 */
export function sourceOf(name: PageName): string {
  const text = fileText(`${name}.md`);
  if (name === 'api') return `${text}\n${operationsMarkdown(readOpenApi())}`;
  if (name === 'kerf-file') return `${text}\n\`\`\`python\n${fileText('read_kerf.py')}\`\`\`\n`;
  return text;
}

function parse(name: PageName): Page {
  const tokens = markdown.parse(sourceOf(name), {});
  const headings: Heading[] = [];
  tokens.forEach((token, i) => {
    if (token.type === 'heading_open') {
      const text = (tokens[i + 1]?.content ?? '').replaceAll('`', '');
      const id = anchorOf(text);
      token.attrSet('id', id);
      headings.push({ level: Number(token.tag.slice(1)), id, text });
    }
    for (const child of token.children ?? []) {
      const href = child.attrGet('href');
      if (href !== null)
        child.attrSet('href', String(href).replace(/^([\w-]+)\.md(#|$)/, '$1.html$2'));
    }
  });
  const title = headings.find(({ level }) => level === 1)?.text ?? name;
  return { name, title, headings, body: markdown.renderer.render(tokens, markdown.options, {}) };
}

const escaped = (text: string): string => markdown.utils.escapeHtml(text);

function navigation(pages: readonly Page[], current: Page): string {
  const sections = current.headings
    .filter(({ level }) => level === 2)
    .map(({ id, text }) => `<li><a href="#${id}">${escaped(text)}</a></li>`)
    .join('\n');
  return pages
    .map((page) => {
      const here = page === current;
      const mark = here ? ' aria-current="page"' : '';
      const below = here && sections ? `<ul>\n${sections}\n</ul>` : '';
      return `<li><a href="${page.name}.html"${mark}>${escaped(page.title)}</a>${below}</li>`;
    })
    .join('\n');
}

function document(pages: readonly Page[], page: Page): string {
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escaped(page.title)} · Kerf manual</title>
<link rel="stylesheet" href="manual.css">
<link rel="icon" href="../icon.svg">
</head>
<body>
<nav aria-label="Manual">
<ul>
${navigation(pages, page)}
</ul>
</nav>
<main>
${page.body}</main>
</body>
</html>
`;
}

/** The files of the manual by their names. */
export function renderManual(): Map<string, string> {
  const pages = PAGES.map(parse);
  const files = new Map(pages.map((page) => [`${page.name}.html`, document(pages, page)]));
  files.set('manual.css', readFileSync(join(import.meta.dirname, 'manual.css'), 'utf8'));
  return files;
}

/** Writes the manual into the folder `manual` of the build. */
export function manual(): Plugin {
  return {
    name: 'manual',
    apply: 'build',
    generateBundle() {
      for (const [name, source] of renderManual())
        this.emitFile({ type: 'asset', fileName: `manual/${name}`, source });
    },
  };
}
