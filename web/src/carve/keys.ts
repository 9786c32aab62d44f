// SPDX-License-Identifier: Apache-2.0
// Keys while one carves. They come before those of the page, which keep all others.

export interface CarveKeyActions {
  /** Ends the stroke, or else the mode. */
  escape: () => void;
  undo: () => void;
  redo: () => void;
  nextTool: (step: 1 | -1) => void;
  /** Takes a wider tool, or a narrower one. */
  resize: (direction: 1 | -1) => void;
  togglePlane: () => void;
  nextAxis: () => void;
  nextMirror: () => void;
  nextString: () => void;
  nextDrag: () => void;
  space: (held: boolean) => void;
}

function actionOf(event: KeyboardEvent, actions: CarveKeyActions): (() => void) | null {
  const key = event.key.toLowerCase();
  if (event.ctrlKey || event.metaKey) {
    if (key === 'z') return event.shiftKey ? actions.redo : actions.undo;
    return key === 'y' ? actions.redo : null;
  }
  if (event.altKey) return null;
  switch (key) {
    case 'escape':
      return actions.escape;
    case '[':
      return () => actions.resize(-1);
    case ']':
      return () => actions.resize(1);
    case '{':
      return () => actions.nextTool(-1);
    case '}':
      return () => actions.nextTool(1);
    case 'p':
      return actions.togglePlane;
    case 'l':
      return actions.nextAxis;
    case 'm':
      return actions.nextMirror;
    case 's':
      return actions.nextString;
    case 'd':
      return actions.nextDrag;
    default:
      return null;
  }
}

/** Handles keys until the returned function is called. */
export function listenToCarveKeys(actions: CarveKeyActions): () => void {
  const stop = new AbortController();
  const options = { capture: true, signal: stop.signal };
  const isElsewhere = (event: KeyboardEvent): boolean =>
    (event.target as HTMLElement).closest('input:not([type=range]), textarea, select, dialog') !==
    null;
  window.addEventListener(
    'keydown',
    (event) => {
      if (isElsewhere(event)) return;
      const isSpace =
        event.key === ' ' && (event.target as HTMLElement).closest('button, input') === null;
      const action = isSpace ? () => actions.space(true) : actionOf(event, actions);
      if (!action) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      action();
    },
    options,
  );
  window.addEventListener('keyup', ({ key }) => key === ' ' && actions.space(false), options);
  window.addEventListener('blur', () => actions.space(false), { signal: stop.signal });
  return () => stop.abort();
}
