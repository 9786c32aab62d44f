// SPDX-License-Identifier: Apache-2.0
// The section of the panel for pins, shared views and pictures. Most of its code is a chunk, which is
// loaded when there are pins or shared views, or when a button is pressed.

import { effect, signal } from '@preact/signals';
import { render } from 'preact';
import { t } from '../../strings';
import { h } from '../dom';
import type { TogetherHost } from './host';
import { Section } from './section';
import type { Action } from './section';
import { TogetherState } from './state';
import type { TogetherPanel } from './together_panel';

export interface Together {
  element: HTMLElement;
  /** Called about ten times a second: sends the camera while it is shared. */
  update: () => void;
}

export function mountTogether(host: TogetherHost): Together {
  const state = new TogetherState();
  const panel = signal<TogetherPanel | null>(null);
  let loading: Promise<void> | null = null;
  const load = async (): Promise<void> => {
    const { TogetherPanel: Panel } = await import('./together_panel');
    if (host.picture.viewer) panel.value = new Panel(host, host.picture.viewer, state);
    loading = null;
  };
  const start = (): Promise<void> =>
    (loading ??= load().catch((problem: unknown) => {
      loading = null;
      console.warn('The section “Together” did not load:', problem);
    }));
  const press = (action: Action): void => {
    if (panel.value) panel.value[action]();
    else void start().then(() => panel.value?.[action]());
  };
  const element = h('section', { 'aria-label': t('Share') });
  render(<Section host={host} state={state} panel={panel} press={press} />, element);
  effect(() => {
    const { pins, cameras } = host.model.together;
    if (!panel.value && host.picture.viewer && pins.length + cameras.length > 0) void start();
  });
  return { element, update: () => panel.value?.update() };
}
