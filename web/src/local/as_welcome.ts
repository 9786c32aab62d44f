// SPDX-License-Identifier: Apache-2.0
// The welcome that a server would send for the page's own block.

import type { Welcome } from '../wire/types';
import type { About } from './program_block';

export function asWelcome(about: About): Welcome {
  const { name, pitch_mm, pivot_mm, stock, tools, grid } = about;
  const scene = { name, pitch_mm, pivot_mm, stock, tools, grid };
  const page = { session: name, participant: 0, epoch: 1, color: '#33404f', participants: [] };
  return { type: 'welcome', ...page, ...scene };
}
