// SPDX-License-Identifier: Apache-2.0

import type { ComponentChildren } from 'preact';

/** Shows a view that depends on signals, such as one whose code is loaded later. */
export function Live({ view }: { view: () => ComponentChildren }) {
  return <>{view()}</>;
}
