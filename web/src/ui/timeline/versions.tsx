// SPDX-License-Identifier: Apache-2.0
// Named versions: go to one, name the block that is shown, rename or delete one. Also a branch: a new
// session that begins with the block that is shown.

import { useSignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../../strings';
import type { Version } from '../../link/history';
import type { SessionModel } from '../../model/session';
import { count } from '../format';

export interface VersionActions {
  go: (record: number) => void;
  name: (name: string) => void;
  rename: (old: string, name: string) => void;
  remove: (name: string) => void;
  branch: (id: string) => void;
}

export interface VersionsProps {
  model: SessionModel;
  /** Its list is the value of a signal. */
  records: { readonly versions: readonly Version[] };
  actions: VersionActions;
  /** Returns a name for a branch from the record that is shown. */
  proposed: () => string;
}

type FormKind = 'version' | 'rename' | 'branch';

const LABELS = {
  version: { input: t('Name of the version'), save: t('Save') },
  rename: { input: t('Name of the version'), save: t('Save name') },
  branch: { input: t('ID of the new session'), save: t('Create branch') },
};

interface NameFormProps {
  kind: FormKind | null;
  text: string;
  write: (text: string) => void;
  save: () => void;
  cancel: () => void;
}

/** The form for the name of a version or the ID of a branch; hidden if `kind` is null. */
function NameForm({ kind, text, write, save, cancel }: NameFormProps) {
  const input = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => {
    if (kind === null) return;
    input.current?.focus();
    input.current?.select();
  }, [kind]);
  const labels = LABELS[kind ?? 'version'];
  const isBranch = kind === 'branch';
  return (
    <form
      class="timeline-form"
      hidden={kind === null}
      onKeyDown={({ key }) => {
        if (key === 'Escape') cancel();
      }}
      onSubmit={(event) => {
        event.preventDefault();
        save();
      }}
    >
      <input
        ref={input}
        class="timeline-input"
        maxLength={64}
        required
        aria-label={labels.input}
        placeholder={labels.input}
        pattern={isBranch ? '[a-z0-9_\\-]{1,64}' : '[^\\/]+'}
        title={isBranch ? t('Lowercase letters, digits, - and _') : ''}
        value={text}
        onInput={({ currentTarget }) => write(currentTarget.value)}
      />
      <button class="timeline-action">{labels.save}</button>
      <button type="button" class="timeline-action" onClick={cancel}>
        {t('Cancel')}
      </button>
    </form>
  );
}

/** The menu of versions. `chosen` is one of them, or undefined. */
function VersionMenu(props: {
  versions: readonly Version[];
  chosen: Version | undefined;
  choose: (name: string) => void;
}) {
  const { versions, chosen, choose } = props;
  return (
    <select
      class="timeline-versions"
      aria-label={t('Versions')}
      value={chosen?.name ?? ''}
      onChange={({ currentTarget }) => choose(currentTarget.value)}
    >
      <option value="">{versions.length === 0 ? t('No versions') : t('Go to version…')}</option>
      {versions.map(({ name, record, author }) => (
        <option key={name} value={name}>
          {`${name} · ${count(record)}${author ? ` · ${author}` : ''}`}
        </option>
      ))}
    </select>
  );
}

/** The controls for versions and branches. */
export function Versions({ model, records, actions, proposed }: VersionsProps) {
  const chosenName = useSignal('');
  const form = useSignal<FormKind | null>(null);
  const text = useSignal('');
  const openers = useRef<Partial<Record<FormKind, HTMLButtonElement | null>>>({});
  const { versions } = records;
  const chosen = versions.find(({ name }) => name === chosenName.value);
  const may = (what: string): boolean => model.welcome?.may?.includes(what) ?? true;
  // The server decides who may change a version of another participant.
  const isFixed = chosen?.may_change !== true;
  const open = (kind: FormKind): void => {
    form.value = kind;
    text.value = kind === 'branch' ? proposed() : kind === 'rename' ? (chosen?.name ?? '') : '';
  };
  const close = (): void => {
    if (form.value) openers.current[form.value]?.focus();
    form.value = null;
  };
  const choose = (name: string): void => {
    chosenName.value = name;
    const version = versions.find((one) => one.name === name);
    if (version) actions.go(version.record);
  };
  const save = (): void => {
    const [kind, name] = [form.value, text.value.trim()];
    close();
    if (name === '') return;
    if (kind === 'branch') actions.branch(name);
    else if (kind === 'version') actions.name(name);
    else if (chosen) actions.rename(chosen.name, name);
  };
  const opener = (kind: FormKind) => ({
    type: 'button' as const,
    class: 'timeline-action',
    ref: (button: HTMLButtonElement | null) => void (openers.current[kind] = button),
    onClick: () => open(kind),
  });
  return (
    <>
      <VersionMenu versions={versions} chosen={chosen} choose={choose} />
      <button {...opener('rename')} hidden={!may('name_versions')} disabled={isFixed}>
        {t('Rename')}
      </button>
      <button
        type="button"
        class="timeline-action"
        hidden={!may('name_versions')}
        disabled={isFixed}
        onClick={() => {
          if (chosen) actions.remove(chosen.name);
        }}
      >
        {t('Delete')}
      </button>
      <button {...opener('version')} hidden={!may('name_versions')}>
        {t('Save a version')}
      </button>
      <button {...opener('branch')} hidden={!may('administer')}>
        {t('Branch from here')}
      </button>
      <NameForm
        kind={form.value}
        text={text.value}
        write={(written) => (text.value = written)}
        save={save}
        cancel={close}
      />
    </>
  );
}
