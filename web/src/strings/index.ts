// SPDX-License-Identifier: Apache-2.0
// The texts of the page in the user's language. In the code they are English; the texts of another
// language are a file of that language, which is loaded before any other code of the page runs.

import { recall } from './memory';

export const LANGUAGES = { en: 'English', de: 'Deutsch', zh: '中文' } as const;
export type Language = keyof typeof LANGUAGES;
/** The texts of a language by the English ones, of which {0}, {1} … are places for values. */
export type Texts = Readonly<Record<string, string>>;

/** The first of the languages wanted that there is: "zh-Hant" counts as "zh". */
export function languageOf(wanted: readonly (string | null)[]): Language {
  for (const one of wanted) {
    const name = one?.slice(0, 2).toLowerCase() ?? '';
    if (Object.hasOwn(LANGUAGES, name)) return name as Language;
  }
  return 'en';
}

async function textsOf(name: Language): Promise<Texts> {
  try {
    if (name === 'de') return (await import('./de.json')).default;
    if (name === 'zh') return (await import('./zh.json')).default;
  } catch (problem) {
    console.warn('The texts did not load:', problem); // English is better than no page
  }
  return {};
}

const browsers = typeof document === 'undefined' ? [] : navigator.languages;

/** Chosen by the user, else by the browser. */
export const language = languageOf([recall('language'), ...browsers]);

let texts: Texts = {};

/** Must have ended before code that has texts is run. English needs none. */
export async function loadTexts(): Promise<void> {
  texts = await textsOf(language);
}

/** Replaces {0}, {1} … */
export function filled(text: string, values: readonly (string | number)[]): string {
  return text.replace(/\{(\d)\}/g, (place, n) => String(values[Number(n)] ?? place));
}

/** A text in the user's language, with its values. */
export function t(english: string, ...values: (string | number)[]): string {
  return filled(texts[english] ?? english, values);
}
