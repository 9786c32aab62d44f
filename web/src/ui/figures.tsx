// SPDX-License-Identifier: Apache-2.0
// Parts of side panels.

import type { ComponentChildren } from 'preact';
import { t } from '../strings';

interface FigureProps {
  label: string;
  value: string;
  unit?: string;
}

/** A number with its unit, under a label. */
export function Figure({ label, value, unit = '' }: FigureProps) {
  return (
    <div class="figure">
      <dt>{label}</dt>
      <dd>
        <b>{value}</b>
        <small>{unit}</small>
      </dd>
    </div>
  );
}

interface SectionProps {
  title: string;
  /** After the title. */
  about?: ComponentChildren;
  hidden?: boolean;
  children: ComponentChildren;
}

/** A part of a panel. */
export function Section({ title, about, hidden, children }: SectionProps) {
  return (
    <section aria-label={title} hidden={hidden}>
      <h2>
        {title}
        {about}
      </h2>
      {children}
    </section>
  );
}

/** Figures for the curious, shown on request. */
export function Details({ children }: { children: ComponentChildren }) {
  return (
    <details class="more">
      <summary>{t('Details')}</summary>
      {children}
    </details>
  );
}
