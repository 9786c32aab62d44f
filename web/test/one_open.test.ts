// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { OneOpen } from '../src/ui/one_open';

it('closes the part that is open when another one opens', () => {
  const one = new OneOpen();
  const open = new Set<string>();
  const part = (name: string) => {
    const close = (): void => {
      open.delete(name);
      one.closed(close);
    };
    return {
      open: () => {
        one.opens(close);
        open.add(name);
      },
      close,
    };
  };
  const [panel, carving] = [part('panel'), part('carving')];
  panel.open();
  carving.open();
  expect([...open]).toEqual(['carving']);
  panel.open();
  expect([...open]).toEqual(['panel']);
  panel.close();
  carving.open();
  expect([...open]).toEqual(['carving']);
});
