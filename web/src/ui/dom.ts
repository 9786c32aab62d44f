// SPDX-License-Identifier: Apache-2.0
// Helpers to build the page's HTML.

type Child = Node | string;

interface Attributes {
  class?: string;
  [name: string]: string | undefined;
}

/** Creates an element with attributes and children. Strings become text nodes, never markup. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/**
 * Creates a button with an icon, an accessible name, and a tooltip that includes the keyboard
 * shortcut.
 */
export function iconButton(
  icon: string,
  label: string,
  key: string,
  action: () => void,
): HTMLButtonElement {
  const button = h('button', {
    type: 'button',
    class: 'icon-button',
    'aria-label': label,
    title: key ? `${label} (${key})` : label,
  });
  button.innerHTML = icon; // only constants of icons.ts
  button.addEventListener('click', action);
  return button;
}

/** Sets an element's text only if it differs, which avoids needless layout. */
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Copies a text; calls `done` when it is copied. On plain HTTP pages may not, and nothing happens. */
export function copyText(text: string, done: () => void): void {
  const clipboard = navigator.clipboard as Clipboard | undefined;
  void clipboard?.writeText(text).then(done);
}
