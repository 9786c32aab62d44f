// SPDX-License-Identifier: Apache-2.0
import { expect, it } from 'vitest';
import { sessionMaterial } from '../src/model/materials';

it('a session of programs has a plain board, one with a hand in it wood', () => {
  expect(sessionMaterial(['program', 'program']).grain).toBe(0);
  expect(sessionMaterial(['program', 'agent']).grain).toBe(1);
  expect(sessionMaterial([]).name).toBe('Limewood');
});
