// SPDX-License-Identifier: Apache-2.0
// The text of a program as a list of which only the rows in view exist, with the live line marked.

import { useSignal, useSignalEffect } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../../strings';
import { rowsInView } from '../../model/line_index';
import type { TextState } from './text_state';

const ROW_PX = 20; // programs.css
const MORE_ROWS = 8;
/** Browsers draw nothing below some 17 million pixels. */
const ROWS_MAX = 800_000;

interface RowProps {
  state: TextState;
  line: number;
  pressed: (line: number) => void;
}

function Row({ state, line, pressed }: RowProps) {
  const mark = state.mark.value;
  const isMarked = line === mark.line;
  const markName = mark.isPlace ? 'placed' : 'marked';
  const text = state.lines.value.line(line);
  const at = isMarked && mark.word !== '' ? text.indexOf(mark.word) : -1;
  return (
    <div
      class={isMarked ? `program-row ${markName}` : 'program-row'}
      style={`top:${(line - 1) * ROW_PX}px`}
      aria-current={line === state.live.value ? 'true' : undefined}
      data-line={String(line)}
      onClick={() => {
        if (getSelection()?.isCollapsed !== false) pressed(line);
      }}
    >
      <span class="program-number" aria-hidden="true">
        {line}
      </span>
      {at < 0 ? text : text.slice(0, at)}
      {at >= 0 && <mark>{mark.word}</mark>}
      {at >= 0 && text.slice(at + mark.word.length)}
    </div>
  );
}

interface TextViewProps {
  state: TextState;
  hidden?: boolean;
  /** A line was pressed. */
  pressed: (line: number) => void;
}

export function TextView({ state, hidden, pressed }: TextViewProps) {
  const element = useRef<HTMLDivElement>(null);
  const scrolledTo = useRef(0); // by the page
  const shown = useSignal({ top: 0, height: 0 });
  const measure = (): void => {
    const { scrollTop: top = 0, clientHeight: height = 0 } = element.current ?? {};
    const { value: before } = shown;
    if (top !== before.top || height !== before.height) shown.value = { top, height };
  };
  const count = Math.min(state.lines.value.count, ROWS_MAX);
  useLayoutEffect(() => {
    if (!element.current) return;
    const observer = new ResizeObserver(measure);
    observer.observe(element.current);
    return () => observer.disconnect();
  }, []);
  useSignalEffect(() => {
    if (state.reveals.value > 0) element.current?.scrollIntoView({ block: 'nearest' });
  });
  const { value: scroll } = state.scroll;
  useLayoutEffect(() => {
    const { current } = element;
    if (!current) return;
    const { scrollTop, clientHeight } = current;
    const top = (scroll.line - 1) * ROW_PX;
    const isHidden = top < scrollTop || top + ROW_PX > scrollTop + clientHeight;
    if (scroll.ifHidden && !isHidden) return;
    current.scrollTop = Math.max(0, top - clientHeight / 2 + ROW_PX / 2);
    scrolledTo.current = current.scrollTop;
    measure();
  }, [scroll]);
  const { top, height } = shown.value;
  const { first, past } = rowsInView(top, height, ROW_PX, count, MORE_ROWS);
  const lines = Array.from({ length: Math.max(0, past - first) }, (_, n) => first + n + 1);
  return (
    <div
      ref={element}
      class="program-text"
      tabIndex={0}
      role="region"
      aria-label={t('Program text')}
      hidden={hidden}
      onScroll={({ currentTarget }) => {
        if (Math.abs(currentTarget.scrollTop - scrolledTo.current) > ROW_PX) state.follow(false);
        measure();
      }}
    >
      <div
        class="program-rows"
        style={`height:${count * ROW_PX}px;--digits:${String(state.lines.value.count).length}`}
      >
        {lines.map((line) => (
          <Row key={line} state={state} line={line} pressed={pressed} />
        ))}
      </div>
    </div>
  );
}
