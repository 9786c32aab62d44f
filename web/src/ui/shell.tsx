// SPDX-License-Identifier: Apache-2.0
// The frame of both pages: the canvas of the picture, its overlay, and the parts around them. It holds
// which parts are open, because some parts give way to others.

import { signal, useSignal } from '@preact/signals';
import { render } from 'preact';
import type { ComponentChildren } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../strings';
import { insetsOf } from './insets';
import type { Viewport } from '../model/fit';

/** CSS variables of the heights of parts at the bottom, px. */
type HeightName = '--carve-bar' | '--inspect' | '--timeline';

export class Shell {
  readonly isTimelineOpen = signal(false);
  readonly isInspectOpen = signal(false);
  readonly isProgramsOpen = signal(false);
  /** Whether the panel is open where it is a sheet at the bottom, on phones. */
  readonly isSheetOpen = signal(false);
  /** Whether files are dragged over the page. */
  readonly isDropping = signal(false);
  readonly isCarving = signal(false);
  /** Whether a press on the block gives a point of a measure. */
  readonly isMeasuring = signal(false);
  /** Whether the next press on the block sets a pin. */
  readonly isAiming = signal(false);
  /** The state of the connection by which this page carves; undefined: it has not carved. */
  readonly carveStatus = signal<string | undefined>(undefined);
  /** The buttons of actions by the names of these; the toolbar writes them. */
  readonly buttons = new Map<string, HTMLElement | null>();
  readonly canvas: HTMLCanvasElement;
  /** Over the picture, for elements that follow the block; does not get the pointer. */
  readonly overlay: HTMLElement;
  readonly main: HTMLElement;
  /** Called after the place that the parts leave to the picture has changed. */
  resized: (viewport: Viewport) => void = () => undefined;

  /** @param embedded part of another page */
  constructor(
    private readonly app: HTMLElement,
    private readonly embedded = false,
  ) {
    app.replaceChildren();
    this.show(null, null);
    this.main = app.querySelector('main')!;
    this.canvas = app.querySelector('canvas')!;
    this.overlay = app.querySelector<HTMLElement>('.overlay')!;
  }

  /** Shows parts of the page: `under` the overlay, and over it. */
  show(under: ComponentChildren, over: ComponentChildren): void {
    render(
      <Frame shell={this} embedded={this.embedded} under={under}>
        {over}
      </Frame>,
      this.app,
    );
  }

  /** Replaces the page. */
  end(view: ComponentChildren): void {
    render(view, this.app);
  }

  /** Measures the place that the parts leave to the picture. */
  readonly layoutChanged = (): void => {
    const width = Math.max(1, this.app.clientWidth);
    const height = Math.max(1, this.app.clientHeight);
    this.resized({ width, height, insets: insetsOf(this.app, width, height) });
  };

  /** Moves the focus to the button of an action, which has closed what it opened. */
  focus(action: string): void {
    this.buttons.get(action)?.focus();
  }

  /** Makes the height of a part known to the styles. */
  setHeight(name: HeightName, px: number): void {
    this.main.style.setProperty(name, `${px}px`);
    this.layoutChanged();
  }
}

interface FrameProps {
  shell: Shell;
  embedded: boolean;
  under: ComponentChildren;
  children: ComponentChildren;
}

/** The names of classes that apply. */
function namesOf(classes: Record<string, boolean>): string {
  return Object.keys(classes)
    .filter((name) => classes[name])
    .join(' ');
}

/** Returns a ref that is true while Tab is what the user has pressed last, of keys and buttons. */
function useLastInput() {
  const isByTab = useRef(false);
  useLayoutEffect(() => {
    const stop = new AbortController();
    const options = { capture: true, signal: stop.signal };
    window.addEventListener('keydown', ({ key }) => (isByTab.current = key === 'Tab'), options);
    window.addEventListener('pointerdown', () => (isByTab.current = false), options);
    return () => stop.abort();
  }, []);
  return isByTab;
}

function Frame({ shell, embedded, under, children }: FrameProps) {
  // Whether the focus came to the picture by Tab: only then is it shown.
  const isTabbed = useSignal(false);
  const isByTab = useLastInput();
  const classes = namesOf({
    viewer: true,
    embedded,
    carving: shell.isCarving.value,
    'has-timeline': shell.isTimelineOpen.value,
    'has-inspect': shell.isInspectOpen.value,
    dropping: shell.isDropping.value,
  });
  useLayoutEffect(() => {
    shell.layoutChanged();
  }, [classes]);
  return (
    <main class={classes} data-carve={shell.carveStatus.value}>
      <canvas
        class={namesOf({
          canvas: true,
          aims: shell.isAiming.value,
          measures: shell.isMeasuring.value,
          tabbed: isTabbed.value,
        })}
        onFocus={() => (isTabbed.value = isByTab.current)}
        tabIndex={0}
        role="img"
        aria-label={t('3D view of the block and the tools')}
      />
      {under}
      <div class="overlay" aria-hidden="true" />
      {children}
    </main>
  );
}

/**
 * Returns a ref for an element that covers a part of the picture. Measures the picture's place again
 * when the size of the element changes, and makes its height known as `name`, if one is given.
 */
export function useCovering<T extends HTMLElement>(shell: Shell, name?: HeightName) {
  const element = useRef<T>(null);
  useLayoutEffect(() => {
    const { current } = element;
    if (!current) return;
    const observer = new ResizeObserver(() => {
      if (name === undefined) shell.layoutChanged();
      else shell.setHeight(name, current.offsetHeight);
    });
    observer.observe(current);
    return () => {
      observer.disconnect();
      // The element is removed after this.
      queueMicrotask(() => {
        if (name === undefined) shell.layoutChanged();
        else shell.setHeight(name, 0);
      });
    };
  }, []);
  return element;
}
