// SPDX-License-Identifier: Apache-2.0
// The strokes of a session, newest first: author, tool, time; each can be undone or redone.

import { language, t } from '../../strings';
import type { Stroke, StrokeChange } from '../../model/stroke';
import { toolName } from '../../model/tool_profile';
import { count } from '../format';
import type { History } from './state';

const SHOWN_MAX = 200;
const CLOCK = new Intl.DateTimeFormat(language, { timeStyle: 'medium', hourCycle: 'h23' });

function Row({ history, stroke }: { history: History; stroke: Stroke }) {
  const { authors, model } = history;
  const name = authors.nameOf(stroke.participant);
  const tool = toolName(model.tool(stroke.tool));
  const change: StrokeChange = stroke.undone ? 'redo' : 'undo';
  const label = change === 'undo' ? t('Undo') : t('Redo');
  const time = CLOCK.format(stroke.begin_ms);
  return (
    <li
      class={stroke.undone ? 'stroke undone' : 'stroke'}
      style={`--who:${authors.colorOf(stroke.participant)}`}
    >
      <span class="stroke-dot" />
      <span>
        {name}
        <small>{`${tool} · ${time}`}</small>
      </span>
      <button
        type="button"
        class="quiet-action"
        aria-label={`${label} ${name}, ${time}`}
        onClick={() => history.changeStroke(change, stroke)}
      >
        {label}
      </button>
    </li>
  );
}

export function StrokeList({ history }: { history: History }) {
  const strokes = history.strokes.value ?? [];
  const newest = strokes.slice(-SHOWN_MAX).reverse();
  const hidden = strokes.length - newest.length;
  return (
    <ol class="strokes" aria-label={t('Strokes, newest first')}>
      {newest.map((stroke) => (
        <Row key={stroke.id} history={history} stroke={stroke} />
      ))}
      {hidden > 0 && <li class="quiet">{t('{0} older strokes', count(hidden))}</li>}
      {history.strokes.value?.length === 0 && <li class="quiet">{t('No strokes yet.')}</li>}
    </ol>
  );
}
