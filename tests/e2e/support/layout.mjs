// SPDX-License-Identifier: Apache-2.0
// What lies where in the page.

import { until } from './processes.mjs';

function intersect(a, b) {
  return a[0] < b[2] - 1 && b[0] < a[2] - 1 && a[1] < b[3] - 1 && b[1] < a[3] - 1;
}

/** Waits until in a page of this size neither the block nor a visible element covers another. */
export async function checkFreeBlock({ page, state }, [width, height], selectors) {
  await page.setViewportSize({ width, height });
  await until(`free block at ${width} × ${height}`, 10, async () => {
    const boxes = await page.evaluate(
      (all) =>
        all
          .map((selector) => document.querySelector(selector)?.getBoundingClientRect())
          .filter((box) => box && box.width > 0)
          .map(({ left, top, right, bottom }) => [left, top, right, bottom]),
      selectors,
    );
    boxes.push((await state()).blockBox);
    return boxes.every((box, n) => boxes.slice(0, n).every((other) => !intersect(box, other)));
  });
}
