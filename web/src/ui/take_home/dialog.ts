// SPDX-License-Identifier: Apache-2.0
// The dialog by which one takes the block home: format, detail, size, progress, cancel.

import { t } from '../../strings';
import '../style/take_home.css';
import { takeHome } from '../../link/take_home';
import type { Progress } from '../../link/take_home';
import { bytesText } from '../../model/new_block';
import { choicesFor, fileOf, GROUPS, sizeOf } from '../../model/take_home';
import type { Amounts, DetailChoice, TakeHomeFormat } from '../../model/take_home';
import { h, setText } from '../dom';
import { sentence } from '../format';

function save(name: string, content: Blob): void {
  const url = URL.createObjectURL(content);
  const link = h('a', { href: url, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

function progressText({ phase, share, bytes }: Progress): string {
  if (phase === 'coming') return t('Downloading: {0}', bytesText(bytes));
  return share === null ? t('Preparing the file…') : t('Preparing the file: {0}', percent(share));
}

function percent(share: number): string {
  return `${Math.floor(100 * share)} %`;
}

export class TakeHomeDialog {
  private readonly detail_ = h('select', { class: 'select', 'aria-label': t('Detail') });
  private readonly size_ = h('p', { class: 'quiet take-size' });
  private readonly start_ = h('button', { type: 'submit', class: 'button' }, t('Download'));
  private readonly cancel_ = h(
    'button',
    { type: 'button', class: 'button quiet-button', hidden: '' },
    t('Cancel'),
  );
  private readonly bar_ = h('progress', { max: '1', 'aria-label': t('Progress'), hidden: '' });
  private readonly note_ = h('p', { class: 'take-note', role: 'status' });
  private readonly dialog_: HTMLDialogElement;
  private format_: TakeHomeFormat;
  private choices_: readonly DetailChoice[] = [];
  private taking_: AbortController | null = null;

  constructor(
    parent: HTMLElement,
    private readonly session: string,
    private readonly amounts: () => Amounts,
  ) {
    this.format_ = GROUPS[0]!.formats[0]!;
    const close = h('button', { type: 'button', class: 'button quiet-button' }, t('Close'));
    const form = h(
      'form',
      {},
      h('div', { class: 'take-groups' }, ...GROUPS.map((group) => this.group_(group))),
      h('p', { class: 'take-detail' }, this.detail_, this.size_),
      h('p', { class: 'take-actions' }, this.start_, this.cancel_, close),
      this.bar_,
      this.note_,
    );
    this.dialog_ = h(
      'dialog',
      { class: 'help take-home', 'aria-label': t('Download') },
      h('h2', {}, t('Download')),
      form,
    );
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      void this.take_();
    });
    close.addEventListener('click', () => this.dialog_.close());
    this.cancel_.addEventListener('click', () => this.taking_?.abort());
    this.detail_.addEventListener('change', () => this.showSize_());
    this.dialog_.addEventListener('close', () => this.taking_?.abort());
    parent.append(this.dialog_);
    this.select_(this.format_);
  }

  open(): void {
    setText(this.note_, '');
    this.showSize_();
    this.dialog_.showModal();
  }

  private group_({ title, formats }: (typeof GROUPS)[number]): HTMLElement {
    const options = formats.map((format) => {
      const input = h('input', { type: 'radio', name: 'take-format', value: format.name });
      input.checked = format === this.format_;
      input.addEventListener('change', () => this.select_(format));
      return h(
        'label',
        { class: 'take-format' },
        input,
        h('b', {}, format.name),
        h('small', {}, format.text),
      );
    });
    return h('fieldset', { class: 'take-group' }, h('legend', {}, title), ...options);
  }

  private select_(format: TakeHomeFormat): void {
    this.format_ = format;
    this.choices_ = choicesFor(format.detail);
    this.detail_.replaceChildren(
      ...this.choices_.map(({ text }, n) => h('option', { value: String(n) }, text)),
    );
    this.detail_.value = '0';
    this.detail_.disabled = this.choices_.length === 1;
    this.showSize_();
  }

  private get choice_(): DetailChoice {
    return this.choices_[Number(this.detail_.value)]!;
  }

  private showSize_(): void {
    const bytes = sizeOf(this.format_, this.choice_, this.amounts());
    setText(this.size_, bytes === null ? '' : t('up to about {0}', bytesText(bytes)));
  }

  private async take_(): Promise<void> {
    if (this.taking_) return;
    const taking = new AbortController();
    this.setTaking_(taking);
    this.note_.classList.remove('bad');
    try {
      const file = fileOf(this.format_, this.choice_);
      const taken = await takeHome(this.session, file, taking.signal, (progress) =>
        this.showProgress_(progress),
      );
      const { name, content, losses } = taken;
      save(name, content);
      const done = t('{0} ({1}) is in your downloads.', name, bytesText(content.size));
      setText(this.note_, [done, ...losses].join(' '));
    } catch (problem) {
      const text = taking.signal.aborted ? t('Cancelled.') : sentence((problem as Error).message);
      setText(this.note_, text);
      this.note_.classList.toggle('bad', !taking.signal.aborted);
    }
    this.setTaking_(null);
  }

  private setTaking_(taking: AbortController | null): void {
    this.taking_ = taking;
    this.start_.disabled = taking !== null;
    this.cancel_.hidden = taking === null;
    this.bar_.hidden = taking === null;
  }

  private showProgress_(progress: Progress): void {
    if (progress.share === null) this.bar_.removeAttribute('value');
    else this.bar_.value = progress.share;
    setText(this.note_, progressText(progress));
  }
}
