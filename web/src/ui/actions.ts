// SPDX-License-Identifier: Apache-2.0
// The commands of the page. Each matter registers its own in one file. The toolbar shows those with
// an icon; keyboard.ts performs those with a key.

export interface Action {
  /** Unique in the page. */
  name: string;
  label: string;
  /** As `F`, `Escape` or `Ctrl+Z`; empty: none. */
  key: string;
  /**
   * Why the viewer's role or the state of the page does not permit the action now, as a sentence;
   * empty: it does. Missing: always permitted.
   */
  whyNot?: () => string;
  perform: () => void;
}

/** An action with a button. Its functions read signals, so the button follows their changes. */
export interface ButtonAction extends Action {
  icon: string;
  /** A further class of the button; missing: none. */
  class?: string;
  isShown?: () => boolean;
  isDisabled?: () => boolean;
  isPressed?: () => boolean;
  /** Whether the panel that the action opens is open. */
  isExpanded?: () => boolean;
}
