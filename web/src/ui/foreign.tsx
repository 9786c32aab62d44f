// SPDX-License-Identifier: Apache-2.0

import { useLayoutEffect, useRef } from 'preact/hooks';

/** Places an element that no component has made, without a box of its own. */
export function Foreign({ element }: { element: HTMLElement }) {
  const root = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => root.current?.replaceChildren(element), [element]);
  return <div ref={root} style="display: contents" />;
}
