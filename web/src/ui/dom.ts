// SPDX-License-Identifier: Apache-2.0
// Building the page: one small function instead of a framework.

type Child = Node | string;

interface Attributes {
  class?: string;
  [name: string]: string | undefined;
}

/** Makes an element with attributes and children. Text is always set as text, never as markup. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Attributes = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** A button with an icon, a name for screen readers and a tooltip that also tells its key. */
export function iconButton(icon: string, label: string, key: string, action: () => void): HTMLButtonElement {
  const button = h('button', { type: 'button', class: 'icon-button', 'aria-label': label, title: key ? `${label} (${key})` : label });
  button.innerHTML = icon; // from icons.ts only
  button.addEventListener('click', action);
  return button;
}

/** Sets a text only if it changes, so that an unchanged page costs no layout. */
export function setText(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
