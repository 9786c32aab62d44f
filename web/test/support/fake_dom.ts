// SPDX-License-Identifier: Apache-2.0
// As much of a page as panels use, for tests without a browser: a tree of elements with attributes,
// texts and listeners. Nothing is laid out.

import { vi } from 'vitest';

export class FakeElement {
  readonly style = { setProperty: () => undefined };
  readonly classList = {
    add: (name: string) => this.setClass_(name, true),
    remove: (name: string) => this.setClass_(name, false),
    toggle: (name: string, on: boolean) => this.setClass_(name, on),
  };
  readonly dataset: Record<string, string> = {};
  readonly clientHeight = 400;
  scrollTop = 0;
  disabled = false;
  checked = false;
  files: unknown[] = [];
  parentElement: FakeElement | null = null;
  /** How often children were put in or taken out. */
  changes = 0;
  private nodes_: (FakeElement | string)[] = [];
  private readonly attributes_ = new Map<string, string>();
  private readonly listeners_ = new Map<string, ((event: unknown) => void)[]>();

  constructor(private readonly tag = '') {}

  get children(): FakeElement[] {
    return this.nodes_.filter((node) => node instanceof FakeElement);
  }
  get options(): FakeElement[] {
    return this.children;
  }
  get textContent(): string {
    return this.nodes_
      .map((node) => (node instanceof FakeElement ? node.textContent : node))
      .join('');
  }
  set textContent(text: string) {
    this.replaceChildren(text);
  }
  get hidden(): boolean {
    return this.attributes_.has('hidden');
  }
  set hidden(hidden: boolean) {
    if (hidden) this.attributes_.set('hidden', '');
    else this.attributes_.delete('hidden');
  }
  get value(): string {
    return this.getAttribute('value') ?? '';
  }
  set value(value: string) {
    this.setAttribute('value', value);
  }
  get valueAsNumber(): number {
    return this.value === '' ? NaN : Number(this.value);
  }

  append(...nodes: (FakeElement | string)[]): void {
    for (const node of nodes) this.put_(node, null);
  }
  insertBefore(node: FakeElement, next: FakeElement | null): void {
    this.put_(node, next);
  }
  replaceChildren(...nodes: (FakeElement | string)[]): void {
    for (const child of this.children) child.parentElement = null;
    this.nodes_ = [];
    this.append(...nodes);
  }
  remove(): void {
    const parent = this.parentElement;
    if (!parent) return;
    parent.nodes_ = parent.nodes_.filter((node) => node !== this);
    parent.changes += 1;
    this.parentElement = null;
  }
  closest(): FakeElement | null {
    return null;
  }
  /** The first element of this name below this one. */
  querySelector(tag: string): FakeElement | null {
    for (const child of this.children) {
      const found = child.tag === tag ? child : child.querySelector(tag);
      if (found) return found;
    }
    return null;
  }
  removeAttribute(name: string): void {
    this.attributes_.delete(name);
  }
  setAttribute(name: string, value: string): void {
    this.attributes_.set(name, value);
  }
  getAttribute(name: string): string | null {
    return this.attributes_.get(name) ?? null;
  }
  addEventListener(name: string, listener: (event: unknown) => void): void {
    this.listeners_.set(name, [...(this.listeners_.get(name) ?? []), listener]);
  }
  dispatch(name: string): void {
    const event = { target: this, preventDefault: () => undefined };
    for (const listener of this.listeners_.get(name) ?? []) listener(event);
  }
  focus(): void {
    this.dispatch('focus');
  }
  select(): void {
    this.dispatch('select');
  }
  click(): void {
    this.dispatch('click');
  }
  /** All elements below this one that have the class. */
  all(name: string): FakeElement[] {
    return this.children.flatMap((child) => [
      ...(child.classes_().includes(name) ? [child] : []),
      ...child.all(name),
    ]);
  }

  private put_(node: FakeElement | string, next: FakeElement | null): void {
    if (node instanceof FakeElement) {
      node.remove();
      node.parentElement = this;
    }
    const at = next ? this.nodes_.indexOf(next) : this.nodes_.length;
    this.nodes_.splice(at, 0, node);
    this.changes += 1;
  }
  private classes_(): string[] {
    return (this.getAttribute('class') ?? '').split(' ');
  }
  private setClass_(name: string, on: boolean): void {
    const others = this.classes_().filter((one) => one !== name);
    this.setAttribute('class', (on ? [...others, name] : others).join(' '));
  }
}

/** Replaces the browser's globals until vi.unstubAllGlobals(); returns the body. */
export function stubPage(): FakeElement {
  const body = new FakeElement();
  const createElement = (tag: string): FakeElement => new FakeElement(tag);
  vi.stubGlobal('document', { body, activeElement: null, createElement });
  vi.stubGlobal(
    'ResizeObserver',
    class {
      readonly observe = (): void => undefined;
    },
  );
  return body;
}
