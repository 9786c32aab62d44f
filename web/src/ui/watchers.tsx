// SPDX-License-Identifier: Apache-2.0
// The viewers who only watch, as chips. The viewer's own chip is a button that makes its name
// editable.

import { useSignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../strings';
import type { SessionModel } from '../model/session';
import { NAME_BYTES_MAX } from '../wire/names';

interface NameFormProps {
  name: string;
  /** Called once or more with the name that the form held. */
  end: (name: string) => void;
}

function NameForm({ name, end }: NameFormProps) {
  const input = useRef<HTMLInputElement>(null);
  const text = useSignal(name);
  useLayoutEffect(() => {
    input.current?.select();
    input.current?.focus();
  }, []);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        end(text.value.trim());
      }}
    >
      <input
        ref={input}
        class="chip-input"
        aria-label={t('Your name')}
        maxLength={NAME_BYTES_MAX}
        value={text.value}
        onInput={({ currentTarget }) => (text.value = currentTarget.value)}
        onBlur={() => end(text.value.trim())}
        onKeyDown={({ key }) => {
          if (key === 'Escape') end(name);
        }}
      />
    </form>
  );
}

interface OwnChipProps {
  name: string;
  renamed: (name: string) => void;
}

function OwnChip({ name, renamed }: OwnChipProps) {
  const isEdited = useSignal(false);
  const end = (chosen: string): void => {
    if (!isEdited.value) return; // removing the form blurs its field
    isEdited.value = false;
    if (chosen !== '' && chosen !== name) renamed(chosen);
  };
  if (isEdited.value)
    return (
      <li>
        <NameForm name={name} end={end} />
      </li>
    );
  return (
    <li>
      <button
        type="button"
        class="chip own"
        title={t('Change your name')}
        onClick={() => (isEdited.value = true)}
      >
        {t('{0} (you)', name)}
      </button>
    </li>
  );
}

export interface WatchersProps {
  model: SessionModel;
  /** The viewer has chosen another name. */
  renamed: (name: string) => void;
}

export function Watchers({ model, renamed }: WatchersProps) {
  const { participants, welcome } = model;
  const shown = participants.watchers().map(({ info }) => info);
  const self = shown.find(({ participant }) => participant === welcome?.participant);
  const listed = participants.all().filter(({ info }) => info.kind === 'viewer').length;
  const unlisted = participants.viewers - listed;
  return (
    <ul class="watchers" aria-label={t('Watching')}>
      {self && <OwnChip key="own" name={self.name} renamed={renamed} />}
      {shown
        .filter((info) => info !== self)
        .map(({ participant, name }) => (
          <li class="chip" key={participant}>
            {name}
          </li>
        ))}
      {unlisted > 0 && (
        <li class="quiet" key="unlisted">
          {t('{0} watching', unlisted)}
        </li>
      )}
    </ul>
  );
}
