// SPDX-License-Identifier: Apache-2.0
// Views in a page, for tests with happy-dom.

import { render } from 'preact';
import type { ComponentChildren } from 'preact';
import { Shell } from '../../src/ui/shell';
import { turn } from './turn';

/** Shows a view as the only one of the page. */
export function show(view: ComponentChildren): HTMLElement {
  const root = document.createElement('div');
  document.body.replaceChildren(root);
  render(view, root);
  return root;
}

/** A page with an empty frame. */
export function emptyShell(): Shell {
  const app = document.createElement('div');
  document.body.replaceChildren(app);
  return new Shell(app);
}

/** The element below another one that has this accessible name. */
export function labelled(root: ParentNode, label: string): HTMLElement {
  const found = [...root.querySelectorAll<HTMLElement>('[aria-label]')].find(
    (one) => one.getAttribute('aria-label') === label,
  );
  if (!found) throw new Error(`nothing is called ${label}`);
  return found;
}

/** The button below an element that has this text. */
export function buttonOf(root: ParentNode, text: string): HTMLButtonElement {
  const found = [...root.querySelectorAll('button')].find((one) => one.textContent === text);
  if (!found) throw new Error(`no button says ${text}`);
  return found;
}

/** Enters a value, as the user does, and waits until the views show it. */
export async function enter(
  field: HTMLInputElement | HTMLSelectElement,
  value: string,
): Promise<void> {
  field.value = value;
  field.dispatchEvent(new Event(field instanceof HTMLSelectElement ? 'change' : 'input'));
  await turn();
}

/** Presses a button, and waits until the views show the outcome. */
export async function press(button: HTMLElement): Promise<void> {
  button.click();
  await turn();
}
