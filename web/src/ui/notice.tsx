// SPDX-License-Identifier: Apache-2.0
// Messages to the user: a notice over the picture, or a full page if there is no picture.

import type { ReadonlySignal } from '@preact/signals';
import { render } from 'preact';

/** The text of a notice; `wait` counts down and is not read aloud. */
export interface NoticeText {
  text: string;
  wait?: string;
  action?: string;
}

interface NoticeProps {
  notice: ReadonlySignal<NoticeText>;
  /** The action was pressed. */
  act: () => void;
}

export function Notice({ notice, act }: NoticeProps) {
  const { text, wait = '', action = '' } = notice.value;
  return (
    <div class="notice" role="alert" hidden={text === ''}>
      <span>{text}</span>
      <span class="notice-wait" aria-hidden="true">
        {wait}
      </span>
      <button type="button" class="notice-action" hidden={action === ''} onClick={act}>
        {action}
      </button>
    </div>
  );
}

export interface FailureProps {
  title: string;
  text: string;
  actions?: readonly { label: string; href: string }[];
}

// The role of main is no part of preact's types.
const ALERT: object = { role: 'alert' };

/** A page that explains a failure and links to possible actions. */
export function Failure({ title, text, actions = [] }: FailureProps) {
  return (
    <main class="page failure" {...ALERT}>
      <h1>{title}</h1>
      <p>{text}</p>
      <p class="page-actions">
        {actions.map(({ label, href }) => (
          <a key={href} class="button" href={href}>
            {label}
          </a>
        ))}
      </p>
    </main>
  );
}

/** Replaces the page by the explanation of a failure. */
export function showFailure(app: HTMLElement, failure: FailureProps): void {
  render(<Failure {...failure} />, app);
}
