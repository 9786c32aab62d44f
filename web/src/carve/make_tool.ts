// SPDX-License-Identifier: Apache-2.0
// Makes a tool while one carves: at the server, or in the page that has the block.

import type { BlockCopy } from '../kernel/block_copy';
import { makeTool } from '../link/tools';
import type { NewTool } from '../model/tool_sizes';
import type { ToolInfo } from '../wire/types';
import type { CarveHost } from './host';

/** The page's copy of the block, if there is one, has it before any motion that uses it. */
export async function makeToolFor(
  host: CarveHost,
  copy: BlockCopy | null,
  wish: NewTool,
): Promise<ToolInfo> {
  const make = host.makeToolHere ?? ((tool) => makeTool(host.session, tool, host.name()));
  const tool = await make(wish);
  copy?.tools(JSON.stringify({ type: 'tools', tools: [tool] }));
  host.model.addTool(tool);
  return tool;
}
