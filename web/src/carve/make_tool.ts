// SPDX-License-Identifier: Apache-2.0
// Makes tools while one carves: at the server, or in the page that has the block.

import type { BlockCopy } from '../kernel/block_copy';
import { makeTool } from '../link/tools';
import type { CarveHost } from './host';
import type { SettingsHost } from './tool_settings';

/** `copy`: the page's copy of the block, if there is one; has a tool before its first motion. */
export function toolMaker(
  host: CarveHost,
  copy: () => BlockCopy | null,
): Pick<SettingsHost, 'tools' | 'mayMake' | 'makeTool'> {
  return {
    tools: () => host.model.tools,
    mayMake: () => host.model.welcome?.may?.includes('make_tools') ?? true,
    makeTool: async (wish) => {
      const make = host.makeToolHere ?? ((tool) => makeTool(host.session, tool, host.name()));
      const tool = await make(wish);
      copy()?.tools(JSON.stringify({ type: 'tools', tools: [tool] }));
      host.model.addTool(tool);
      return tool;
    },
  };
}
