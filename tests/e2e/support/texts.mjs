// SPDX-License-Identifier: Apache-2.0
// The texts of a page: its visible ones, and the labels that are shown or read aloud; and whether they
// lie on each other. Functions that run in the browser.

/** All visible texts and labels. */
export function textsIn(page) {
  return page.evaluate(() => {
    const texts = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_ELEMENT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
      if (!node.checkVisibility()) continue;
      for (const name of ['aria-label', 'title', 'placeholder', 'alt', 'aria-valuetext'])
        if (node.getAttribute(name)) texts.add(node.getAttribute(name).trim());
      if (node.closest('[lang]') !== document.documentElement) continue; // names of languages
      for (const child of node.childNodes)
        if (child.nodeType === Node.TEXT_NODE && child.data.trim()) texts.add(child.data.trim());
    }
    return [...texts];
  });
}

/** Pairs of texts and controls of an element that lie on each other, and texts that are cut off. */
export function clashesIn(page, selector) {
  return page.evaluate((root) => {
    const clipped = (element) => {
      let { left, top, right, bottom } = element.getBoundingClientRect();
      for (let at = element.parentElement; at; at = at.parentElement) {
        if (getComputedStyle(at).overflow === 'visible') continue;
        const box = at.getBoundingClientRect();
        [left, top] = [Math.max(left, box.left), Math.max(top, box.top)];
        [right, bottom] = [Math.min(right, box.right), Math.min(bottom, box.bottom)];
      }
      return { left, top, right, bottom };
    };
    const controls = 'button, a, input, select, progress, [role=slider]';
    const hasText = (element) =>
      [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
    const all = [...document.querySelectorAll(`${root} *`)].filter(
      (element) =>
        element.checkVisibility({ opacityProperty: true, visibilityProperty: true }) &&
        !element.closest('svg, canvas, option, .program-rows, .cube-face, .cut-frames') &&
        (element.matches(controls) || hasText(element)),
    );
    const found = [];
    const name = (element) => (element.textContent || element.ariaLabel || element.tagName).trim();
    all.forEach((one, n) => {
      if (one.matches('button') && one.scrollWidth > one.clientWidth + 2)
        found.push(`cut: ${name(one)}`);
      const a = clipped(one);
      for (const other of all.slice(0, n)) {
        if (one.contains(other) || other.contains(one)) continue;
        const b = clipped(other);
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 1.5 && high > 1.5) found.push(`${name(one)} / ${name(other)}`);
      }
    });
    return found;
  }, selector);
}
