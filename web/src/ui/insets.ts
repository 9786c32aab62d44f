// SPDX-License-Identifier: Apache-2.0
// What bar, toolbar and panels cover of the picture.

import type { Insets } from '../model/fit';

/** Panels at the side leave the picture this much, or they overlap it. */
const FREE_PX = 200;
const SIDES = ['panel', 'inspect', 'programs'];

/** The margins of a picture of `width` × `height` CSS pixels that panels cover. */
export function insetsOf(app: HTMLElement, width: number, height: number): Insets {
  const boxOf = (name: string): DOMRect | null => {
    const box = app.querySelector(`.${name}:not([hidden])`)?.getBoundingClientRect();
    return box && box.width > 0 ? box : null;
  };
  const toolbar = boxOf('toolbar');
  const timeline = boxOf('timeline');
  const actions = boxOf('main-actions'); // on phones it is at the bottom
  const isLow = actions !== null && actions.top > height / 4;
  const bar = (boxOf('past-banner') ?? boxOf('bar'))?.bottom ?? 0;
  const top = isLow ? bar : Math.max(bar, actions?.bottom ?? 0);
  const carve = boxOf('carve-bar'); // on phones it hides panel and toolbar
  const highest = isLow ? actions.top : height;
  const panels = SIDES.map(boxOf).filter((box) => box !== null);
  const sheets = [...panels, timeline].filter((box) => box !== null && box.width > 0.9 * width);
  if (sheets.length > 0 && !carve) {
    const sheet = toolbar?.top ?? Math.min(...sheets.map((one) => one!.top));
    const above = Math.min(highest, sheet);
    return { left: 0, right: 0, top, bottom: Math.min(0.75 * height, Math.max(0, height - above)) };
  }
  const lowest = carve ?? timeline;
  const bottom = lowest ? height - Math.min(highest, lowest.top) : 24;
  const tools = toolbar?.right ?? 0;
  const isLeft = (box: DOMRect): boolean => box.left + box.right < width;
  const right = Math.max(0, ...panels.filter((box) => !isLeft(box)).map((box) => width - box.left));
  const left = Math.max(tools, ...panels.filter(isLeft).map((box) => box.right));
  return { left: width - left - right < FREE_PX ? tools : left, right, top, bottom };
}
