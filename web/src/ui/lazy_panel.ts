// SPDX-License-Identifier: Apache-2.0
// A panel whose code is a chunk of its own, loaded when the panel is opened first.

export interface Panel {
  toggle: () => void;
}

/**
 * Returns a function that opens and closes the panel. A chunk that did not load is loaded again by
 * the next press.
 * @param name for the console
 */
export function lazyPanel(name: string, load: () => Promise<Panel>): () => void {
  let panel: Panel | null = null;
  let loading = false;
  return () => {
    if (panel) {
      panel.toggle();
    } else if (!loading) {
      loading = true;
      load().then(
        (loaded) => {
          panel = loaded;
          panel.toggle();
        },
        (problem: unknown) => {
          loading = false;
          console.warn(`The ${name} did not load:`, problem);
        },
      );
    }
  };
}
