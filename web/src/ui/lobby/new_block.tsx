// SPDX-License-Identifier: Apache-2.0
// The form of a new block: from a template, a model or a program; name, accuracy with its price.

import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { useSignal } from '@preact/signals';
import { t } from '../../strings';
import { templateText } from '../../strings/names';
import { PROGRAM_ENDINGS } from '../../model/programs';
import { ICONS } from '../icons';
import { AccuracyField } from './accuracy';
import { MESH_ENDINGS } from './drafts';
import type { NewBlock } from './new_block_state';

const NAME_CHARACTERS_MAX = 80;

interface BlockProps {
  block: NewBlock;
}

interface FileChoiceProps extends BlockProps {
  title: string;
  text: string;
  endings: readonly string[];
}

function FileChoice({ block, title, text, endings }: FileChoiceProps) {
  return (
    <label class="drop">
      <span style="display: contents" dangerouslySetInnerHTML={{ __html: ICONS.upload }} />
      <input
        type="file"
        class="drop-input"
        accept={endings.join(',')}
        aria-label={title}
        disabled={block.whyNot.value !== ''}
        onChange={({ currentTarget }) => {
          const file = currentTarget.files?.[0];
          if (file) void block.read(file);
          currentTarget.value = ''; // the same file may be chosen again
        }}
      />
      <b>{title}</b>
      <small>{text}</small>
    </label>
  );
}

function Templates({ block }: BlockProps) {
  return (
    <div class="choices" role="group" aria-label={t('Start from')}>
      {block.templates.map((template) => (
        <button
          key={template.title}
          type="button"
          class="choice"
          aria-pressed={template === block.template.value}
          disabled={block.whyNot.value !== ''}
          onClick={() => block.choose(template)}
        >
          <b>{templateText(template.title)}</b>
          <small>{templateText(template.description)}</small>
        </button>
      ))}
    </div>
  );
}

function FaultNote({ block }: BlockProps) {
  const { value: whyNot } = block.whyNot;
  const { text, line, repairable } = block.fault.value ?? {};
  const shown = whyNot || text;
  return (
    <div class="fault" role="alert" hidden={!shown}>
      {shown && <p>{shown}</p>}
      {repairable && (
        <button type="button" class="button" onClick={() => void block.read(repairable, true)}>
          {t('Close holes')}
        </button>
      )}
      {line && <code>{line}</code>}
    </div>
  );
}

function Form({ block }: BlockProps) {
  const form = useRef<HTMLFormElement>(null);
  const { value: draft } = block.draft;
  useLayoutEffect(() => {
    if (draft) form.current?.scrollIntoView({ block: 'nearest' });
  }, [draft]);
  const isDisabled = block.isBusy.value || !block.accuracy.isPossible.value;
  return (
    <form
      ref={form}
      class="new-block-form"
      hidden={draft === null}
      onSubmit={(event) => {
        event.preventDefault();
        void block.create();
      }}
    >
      <label class="field">
        <span class="field-name">{t('Name')}</span>
        <input
          class="text-input"
          maxLength={NAME_CHARACTERS_MAX}
          value={block.name.value}
          onInput={({ currentTarget }) => (block.name.value = currentTarget.value)}
        />
      </label>
      <div class="draft">{draft?.form}</div>
      <AccuracyField accuracy={block.accuracy} />
      <button type="submit" class="button" disabled={isDisabled || block.whyNot.value !== ''}>
        {draft?.program ? t('Create and run') : t('Create')}
      </button>
    </form>
  );
}

/** Files may be dropped anywhere on the page. Returns whether one is dragged over it. */
function usePageDrops(block: NewBlock): boolean {
  const isOver = useSignal(false);
  useEffect(() => {
    const stop = new AbortController();
    const { signal } = stop;
    const listen = (name: 'dragover' | 'dragleave' | 'drop', act: (event: DragEvent) => void) =>
      document.body.addEventListener(name, act, { signal });
    const leave = (): void => void (isOver.value = false);
    listen('dragover', (event) => {
      if (block.whyNot.peek() !== '' || !event.dataTransfer?.types.includes('Files')) return;
      event.preventDefault();
      isOver.value = true;
    });
    listen('dragleave', leave);
    listen('drop', (event) => {
      leave();
      if (block.whyNot.peek() !== '') return;
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file) void block.read(file);
    });
    return () => stop.abort();
  }, [block]);
  return isOver.value;
}

export function NewBlockForm({ block }: BlockProps) {
  const isDropping = usePageDrops(block);
  const isForbidden = block.whyNot.value !== '';
  const classes = ['new-block', isDropping && 'dropping', isForbidden && 'forbidden'];
  return (
    <section id="new-block" class={classes.filter(Boolean).join(' ')} aria-label={t('New block')}>
      <h2>{t('New block')}</h2>
      <div class="drops">
        <FileChoice
          block={block}
          title={t('Run an NC program')}
          text={t('Drop or choose G-code or APT')}
          endings={PROGRAM_ENDINGS}
        />
        <FileChoice
          block={block}
          title={t('Carve a model')}
          text={t('Drop or choose STL, 3MF, GLB, PLY or OBJ')}
          endings={MESH_ENDINGS}
        />
      </div>
      <p class="quiet">{t('or start from')}</p>
      <Templates block={block} />
      <p class="quiet" role="status">
        {block.note.value}
      </p>
      <FaultNote block={block} />
      <Form block={block} />
    </section>
  );
}
