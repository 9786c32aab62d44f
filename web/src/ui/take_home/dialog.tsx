// SPDX-License-Identifier: Apache-2.0
// The dialog by which one takes the block home: format, detail, size, progress, cancel.

import { useSignalEffect } from '@preact/signals';
import type { Signal } from '@preact/signals';
import { useMemo } from 'preact/hooks';
import { t } from '../../strings';
import '../style/take_home.css';
import type { SessionModel } from '../../model/session';
import { GROUPS } from '../../model/take_home';
import { Dialog } from '../dialog';
import { ProgressBar } from '../progress_bar';
import { TakeHomeState } from './state';

function Groups({ state }: { state: TakeHomeState }) {
  return (
    <div class="take-groups">
      {GROUPS.map(({ title, formats }) => (
        <fieldset key={title} class="take-group">
          <legend>{title}</legend>
          {formats.map((format) => (
            <label key={format.name} class="take-format">
              <input
                type="radio"
                name="take-format"
                value={format.name}
                checked={format === state.format.value}
                onChange={() => state.chooseFormat(format)}
              />
              <b>{format.name}</b>
              <small>{format.text}</small>
            </label>
          ))}
        </fieldset>
      ))}
    </div>
  );
}

function DetailRow({ state }: { state: TakeHomeState }) {
  const { value: details } = state.details;
  return (
    <p class="take-detail">
      <select
        class="select"
        aria-label={t('Detail')}
        disabled={details.length === 1}
        value={String(state.detail.value)}
        onChange={({ currentTarget }) => (state.detail.value = Number(currentTarget.value))}
      >
        {details.map(({ text }, n) => (
          <option key={n} value={String(n)}>
            {text}
          </option>
        ))}
      </select>
      <span class="quiet take-size">{state.size.value}</span>
    </p>
  );
}

interface TakeHomeDialogProps {
  model: SessionModel;
  session: string;
  isOpen: Signal<boolean>;
}

export function TakeHomeDialog({ model, session, isOpen }: TakeHomeDialogProps) {
  const state = useMemo(() => new TakeHomeState(model, session), [model, session]);
  useSignalEffect(() => {
    if (isOpen.value) state.forgetNote();
  });
  const isTaking = state.isTaking.value;
  const { text, isBad } = state.note.value;
  return (
    <Dialog
      class="help take-home"
      label={t('Download')}
      isOpen={isOpen}
      closed={() => state.cancel()}
    >
      <h2>{t('Download')}</h2>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          void state.take();
        }}
      >
        <Groups state={state} />
        <DetailRow state={state} />
        <p class="take-actions">
          <button type="submit" class="button" disabled={isTaking}>
            {t('Download')}
          </button>
          <button
            type="button"
            class="button quiet-button"
            hidden={!isTaking}
            onClick={() => state.cancel()}
          >
            {t('Cancel')}
          </button>
          <button type="button" class="button quiet-button" onClick={() => (isOpen.value = false)}>
            {t('Close')}
          </button>
        </p>
        <ProgressBar share={state.share.value} hidden={!isTaking} />
        <p class={isBad ? 'take-note bad' : 'take-note'} role="status">
          {text}
        </p>
      </form>
    </Dialog>
  );
}
