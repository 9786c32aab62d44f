// SPDX-License-Identifier: Apache-2.0
// The glossary of src/strings/README.md: one term for one thing in each language.
import { describe, expect, it } from 'vitest';
import DE from '../src/strings/de.json';
import ZH from '../src/strings/zh.json';

const ENTRIES = Object.keys(DE);

/** Terms that the glossary replaces. */
const words = (...some: string[]): RegExp =>
  new RegExp(`(?<!\\p{L})(${some.join('|')})(?!\\p{L})`, 'iu');
const RETIRED = {
  en: [
    words('journals?', 'records?', 'RTT', 'pitch', 'person', 'cannot', 'take home'),
    words('press (a|the|two|three)', 'millimetres?', 'aluminium', 'colou?red by', 'colour'),
  ],
  de: [
    words('Ihr(e[nmrs]?)?', 'Ihnen', 'Satz', 'Sätze', 'Eintr(ag|äge)', 'gefräst', 'Fräsen'),
    words('Nadeln?', 'Personen', 'Journals?', 'zurückgenommen', 'zurücknehmen', 'Mitnehmen'),
    words('Einzelheiten', 'Prüfsumme', 'Geschwindigkeit', 'verfolgt'),
  ],
  zh: [/方块|笔画|画面|日志|记录|你|剖切|带走|您的名称/],
};
/** Polite address, which “du” replaces; “Sie” at the start of a sentence is “they”. */
const POLITE = /\S\s+Sie\b(?<![.!?:]\s+Sie)/;

/** Words of the inside of Kerf, which belong under “Details” and into the choice of a download. */
const JARGON = /\b(motions?|triangles?|hash|grid spacing|frames\/s|round trip)\b/i;
const DETAILS = [
  'Motions',
  'Triangles',
  'Grid spacing',
  'State hash ',
  'State hash: the same hash means the same block',
  'State hash: kerf-carve prints the same one for the same files',
  'Round trip {0} · {1} frames/s · {2}',
  '{0} per motion',
  'up to {0} triangles',
];

describe('the words of the page', () => {
  it.each([
    ['en', ENTRIES],
    ['de', Object.values(DE)],
    ['zh', Object.values(ZH)],
  ] as const)('keep to the glossary in %s', (language, texts) => {
    const isRetired = (text: string): boolean => RETIRED[language].some((one) => one.test(text));
    expect(texts.filter(isRetired)).toEqual([]);
  });

  it('address the user with “du” in German, and with “您” in Chinese', () => {
    expect(Object.values(DE).filter((text) => POLITE.test(text))).toEqual([]);
  });

  it('leave jargon to Details', () => {
    expect(ENTRIES.filter((text) => JARGON.test(text)).sort()).toEqual([...DETAILS].sort());
  });

  it.each([
    ['block', /Block|blöcke/, /工件/],
    ['stock', /Rohteil/, /毛坯/],
    ['stroke', /Strich/, /笔触/],
    ['participant', /Teilnehmer/, /参与者/],
    ['tool', /Werkzeug/, /刀具/],
    ['section', /Schnitt(ansicht|ebene)/, /剖面/],
    ['session', /Sitzung/, /会话/],
    ['pin', /\bPins?\b/, /图钉/],
  ] as const)('say “%s” with one term', (term, german, chinese) => {
    const used = ENTRIES.filter((text) => new RegExp(`\\b${term}s?\\b(?!=)`, 'i').test(text));
    const of = (texts: Record<string, string>, wanted: RegExp): string[] =>
      used.filter((key) => !wanted.test(texts[key]!));
    expect(used.length).toBeGreaterThan(3);
    expect(of(DE, german)).toEqual([]);
    expect(of(ZH, chinese)).toEqual([]);
  });
});
