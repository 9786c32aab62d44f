// SPDX-License-Identifier: Apache-2.0
import { readdirSync, readFileSync } from 'node:fs';
import ts from 'typescript';
import { describe, expect, it } from 'vitest';
import { filled, languageOf } from '../src/strings';
import type { Texts } from '../src/strings';
import DE from '../src/strings/de.json';
import ZH from '../src/strings/zh.json';

const SOURCES = new URL('../src/', import.meta.url);
/** Attributes that are shown or read aloud. */
const TOLD = /^(aria-label|aria-description|aria-valuetext|title|placeholder|alt)$/;
/** The same in every language: names of programs, formats, units and keys. */
const NAMES = /^(Kerf|KERF|CAM|CAD|N·mm|mm)$/;

function parsed(file: string): ts.SourceFile {
  const text = readFileSync(new URL(file, SOURCES), 'utf8');
  return ts.createSourceFile(file, text, ts.ScriptTarget.ES2022, true);
}

function each(node: ts.Node, use: (node: ts.Node) => void): void {
  use(node);
  ts.forEachChild(node, (child) => each(child, use));
}

const FILES = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' })
  .filter((file) => /\.tsx?$/.test(file))
  .map(parsed);

/** The texts that the page gives to t(). */
function used(): Set<string> {
  const texts = new Set<string>();
  for (const file of FILES)
    each(file, (node) => {
      if (!ts.isCallExpression(node) || node.expression.getText() !== 't') return;
      const [text] = node.arguments;
      if (text && ts.isStringLiteralLike(text)) texts.add(text.text);
      else if (!file.fileName.startsWith('strings/')) throw new Error(node.getText());
    });
  return texts;
}

const places = (text: string): string[] => (text.match(/\{\d\}/g) ?? []).sort();

describe('the texts of the page', () => {
  it.each([
    ['de', DE],
    ['zh', ZH],
  ] as [string, Texts][])('are all there in %s, with the same places for values', (_, texts) => {
    const english = used();
    expect(english.size).toBeGreaterThan(400);
    expect(Object.keys(texts).sort()).toEqual([...english].sort());
    for (const [key, text] of Object.entries(texts)) {
      expect(text.trim(), key).not.toBe('');
      expect(places(text), key).toEqual(places(key));
    }
  });

  it('are in German and Chinese not those in English, but for names', () => {
    const same = (texts: Texts): string[] =>
      Object.entries(texts)
        .filter(([key, text]) => key === text && /[a-z]{3}/.test(key))
        .map(([key]) => key);
    const shared = [
      'Alarm',
      'Details',
      'Downloads',
      'Live',
      'Material',
      'Name',
      'Parallel',
      'Pins',
      'Radius',
      'live',
    ];
    expect(same(DE).filter((key) => !shared.includes(key))).toEqual([]);
    expect(same(ZH).filter((key) => !/^(Ctrl|Shift)/.test(key))).toEqual([]);
  });

  it('are given to t() wherever an element is made', () => {
    const plain: string[] = [];
    const noteText = (text: string, file: ts.SourceFile): void => {
      if (/[A-Za-z]{2}/.test(text) && !NAMES.test(text.trim()))
        plain.push(`${file.fileName}: ${text}`);
    };
    const note = (node: ts.Expression | undefined, file: ts.SourceFile): void => {
      if (node && ts.isStringLiteralLike(node)) noteText(node.text, file);
    };
    for (const file of FILES)
      each(file, (node) => {
        if (ts.isCallExpression(node)) {
          const called = node.expression.getText();
          if (/(^|\.)(setText|say|say_)$/.test(called)) note(node.arguments.at(-1), file);
        }
        if (ts.isJsxText(node)) noteText(node.text, file);
        if (ts.isJsxAttribute(node) && TOLD.test(node.name.getText())) note(node.initializer, file);
        if (ts.isJsxExpression(node) && !ts.isJsxAttribute(node.parent))
          note(node.expression, file);
        if (ts.isPropertyAssignment(node) && TOLD.test(node.name.getText().replaceAll("'", '')))
          note(node.initializer, file);
      });
    expect(plain).toEqual([]);
  });

  it('are of the first language that there is', () => {
    expect(languageOf([null, 'fr-CA', 'de-AT', 'en'])).toBe('de');
    expect(languageOf(['zh', 'de'])).toBe('zh');
    expect(languageOf(['zh-Hant-TW'])).toBe('zh');
    expect(languageOf(['toString', 'pt'])).toBe('en');
    expect(languageOf([])).toBe('en');
  });

  it('have their values in the places of the language', () => {
    expect(filled('{1} of {0}: {0}', ['a', 3])).toBe('3 of a: a');
    expect(filled('{0} and {2}', ['{1}', 'x'])).toBe('{1} and {2}');
  });
});
