// SPDX-License-Identifier: Apache-2.0
// Which part a program is to make: cuts below it are alarms while the program runs.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import { listTargets } from '../../link/targets';
import { partTolerance, rememberPartTolerance } from '../part_tolerance';

/** The part that a program is watched for gouges into, out of those of the session. */
export class TargetChoice {
  private readonly parts_ = signal<readonly string[]>([]);
  private readonly chosen_ = signal<string | null>(null); // null: the first part
  private readonly toleranceText_ = signal('');
  /** Whether the tolerance is being typed. */
  readonly isTyped = signal(false);

  constructor(private readonly session: string) {}

  /** Requests the parts, which other viewers may have changed. Rejects with a ServerError. */
  async update(pitchMm: number | undefined): Promise<void> {
    const parts = (await listTargets(this.session)).map(({ name }) => name);
    this.parts_.value = parts;
    const chosen = this.chosen_.peek();
    if (chosen !== null && chosen !== '' && !parts.includes(chosen)) this.chosen_.value = null;
    if (!this.isTyped.peek()) this.toleranceText_.value = String(partTolerance(pitchMm));
  }

  get parts(): readonly string[] {
    return this.parts_.value;
  }

  /** Empty: no part is watched. */
  get part(): string {
    return this.chosen_.value ?? this.parts[0] ?? '';
  }

  set part(name: string) {
    this.chosen_.value = name;
  }

  get toleranceText(): string {
    return this.toleranceText_.value;
  }

  set toleranceText(text: string) {
    this.toleranceText_.value = text;
  }

  /** Remembers the tolerance for the next program. */
  rememberTolerance(): void {
    const mm = Number(this.toleranceText);
    if (mm > 0) rememberPartTolerance(mm);
  }

  /** The part of the query that starts a program; empty: no part is watched. */
  get query(): string {
    const mm = Number(this.toleranceText);
    if (this.part === '') return '';
    const tolerance = mm > 0 ? `&target_tolerance_mm=${mm}` : '';
    return `&target=${encodeURIComponent(this.part)}${tolerance}`;
  }
}

export function TargetRow({ choice }: { choice: TargetChoice }) {
  const { parts, part } = choice;
  return (
    <p class="program-options" hidden={parts.length === 0}>
      <select
        class="program-speed"
        aria-label={t('Part the program makes')}
        value={part}
        onChange={({ currentTarget }) => (choice.part = currentTarget.value)}
      >
        <option value="">{t("don't watch for gouges")}</option>
        {parts.map((name) => (
          <option key={name} value={name}>
            {t('watch for gouges into {0}', name)}
          </option>
        ))}
      </select>
      <label hidden={part === ''}>
        {' ± '}
        <input
          type="number"
          class="program-tolerance"
          min="0"
          step="any"
          aria-label={t('Tolerance')}
          value={choice.toleranceText}
          onFocus={() => (choice.isTyped.value = true)}
          onBlur={() => (choice.isTyped.value = false)}
          onInput={({ currentTarget }) => (choice.toleranceText = currentTarget.value)}
          onChange={() => choice.rememberTolerance()}
        />
        {' mm'}
      </label>
    </p>
  );
}
