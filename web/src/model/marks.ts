// SPDX-License-Identifier: Apache-2.0
// When the steps of the page's start happened, ms after the first line of its script. Published as
// window.kerf.marks. Must be the first import of the page.

const startMs = performance.now();

export type Mark = 'hello' | 'welcome' | 'view' | 'picture' | 'block';

export const marks: Partial<Record<Mark, number>> = {};

/** Notes the time of a step; only its first time counts. */
export function mark(step: Mark): void {
  marks[step] ??= performance.now() - startMs;
}
