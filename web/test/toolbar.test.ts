// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h } from 'preact';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { ButtonAction } from '../src/ui/actions';
import type { Shell } from '../src/ui/shell';
import { Toolbar } from '../src/ui/toolbar';
import { emptyShell, labelled } from './support/shown';
import { turn } from './support/turn';

describe('the toolbar', () => {
  const perform = vi.fn();
  const isOpen = signal(false);
  const reason = signal('');
  const isThere = signal(false);
  let shell: Shell;

  beforeEach(() => {
    vi.clearAllMocks();
    isOpen.value = isThere.value = false;
    reason.value = '';
    const common = { icon: '<svg></svg>', perform };
    const actions: ButtonAction[] = [
      { ...common, name: 'panel', label: 'Panel', key: 'P', isExpanded: () => isOpen.value },
      { ...common, name: 'carve', label: 'Carve', key: 'C', whyNot: () => reason.value },
      { ...common, name: 'vr', label: 'VR', key: '', isShown: () => isThere.value },
    ];
    shell = emptyShell();
    shell.show(null, h(Toolbar, { shell, actions }));
  });
  const button = (label: string): HTMLButtonElement =>
    labelled(document, label) as HTMLButtonElement;

  it('names the key of an action, and performs it', () => {
    expect(button('Panel').title).toBe('Panel (P)');
    button('Panel').click();
    expect(perform).toHaveBeenCalledOnce();
  });

  it('follows the state of an action', async () => {
    expect(button('Panel').getAttribute('aria-expanded')).toBe('false');
    isOpen.value = true;
    await turn();
    expect(button('Panel').getAttribute('aria-expanded')).toBe('true');
  });

  it('says why an action cannot be performed', async () => {
    expect(button('Carve').getAttribute('aria-disabled')).toBe('false');
    reason.value = 'The view is still loading.';
    await turn();
    expect(button('Carve').title).toBe('Carve: The view is still loading.');
    expect(button('Carve').getAttribute('aria-disabled')).toBe('true');
    expect(button('Carve').getAttribute('aria-description')).toBe('The view is still loading.');
  });

  it('adds the button of an action that becomes available', async () => {
    expect(() => button('VR')).toThrow('nothing is called');
    isThere.value = true;
    await turn();
    expect(button('VR').title).toBe('VR');
  });

  it('gets the focus back from a panel that was closed', () => {
    shell.focus('panel');
    expect(document.activeElement).toBe(button('Panel'));
  });

  it('is below the sheet while that is open', async () => {
    shell.isSheetOpen.value = true;
    await turn();
    expect(document.querySelector('.toolbar')!.classList.contains('covered')).toBe(true);
  });
});
