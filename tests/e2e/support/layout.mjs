// SPDX-License-Identifier: Apache-2.0
// Positions and overlaps of the elements of a page.

import { until } from './processes.mjs';

const SETTLE_S = 60; // software WebGL on a busy machine

function intersect(a, b) {
  return a[0] < b[2] - 1 && b[0] < a[2] - 1 && a[1] < b[3] - 1 && b[1] < a[3] - 1;
}

/** Boxes of the visible elements, one for each selector: name, and left, top, right, bottom. */
export function boxesIn(page, selectors) {
  return page.evaluate(
    (all) =>
      all
        .map((selector) => [selector, document.querySelector(selector)?.getBoundingClientRect()])
        .filter(([, box]) => box && box.width > 0)
        .map(([selector, { left, top, right, bottom }]) => [selector, [left, top, right, bottom]]),
    selectors,
  );
}

/**
 * Returns the pairs of visible elements, one for each selector, that intersect; `others` are further
 * boxes: left, top, right, bottom.
 */
export async function intersecting(page, selectors, others = []) {
  const boxes = await boxesIn(page, selectors);
  boxes.push(...others.map((box) => ['block', box]));
  return boxes.flatMap(([name, box], n) =>
    boxes
      .slice(0, n)
      .filter(([, other]) => intersect(box, other))
      .map(([other]) => `${other} / ${name}`),
  );
}

/** The names of those boxes that leave a window of this size. */
export function outside(boxes, [width, height]) {
  return boxes
    .filter(([, box]) => box[0] < -1 || box[1] < -1 || box[2] > width + 1 || box[3] > height + 1)
    .map(([name, box]) => `${name} leaves the window: ${box.map(Math.round).join(', ')}`);
}

/** Waits until in a page of this size neither the block nor a visible element covers another. */
export async function checkFreeBlock({ page, state }, [width, height], selectors) {
  await page.setViewportSize({ width, height });
  await until(`free block at ${width} × ${height}`, SETTLE_S, async () => {
    const found = await intersecting(page, selectors, [(await state()).blockBox]);
    if (found.length > 0) throw new Error(found.join(', '));
    return true;
  });
}
