// SPDX-License-Identifier: Apache-2.0
// The request that makes a tool in a session.

import { object } from '../wire/json_fields';
import { toolOf } from '../wire/control';
import type { ToolInfo } from '../wire/types';
import { pathOf } from './address';
import { ask } from './strokes';

/**
 * Makes a tool, or returns the one with this outline that the session has. Rejects with a sentence
 * that says why not. `author` counts on a server that does not know the viewer's name.
 */
export async function makeTool(
  session: string,
  tool: Omit<ToolInfo, 'id'>,
  author: string,
): Promise<ToolInfo> {
  const query = new URLSearchParams({ author }).toString().replaceAll('+', '%20');
  const answer = await ask(pathOf(session, `tools?${query}`), 'POST', JSON.stringify(tool));
  return toolOf(object(answer, 'answer')['tool']);
}
