// SPDX-License-Identifier: Apache-2.0
// The tools of a scene before it becomes a block: silhouettes, to be added, removed and given other
// outlines.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import '../style/tools.css';
import { newTool, pointsOf } from '../../model/profile_draft';
import { toolName, toolProfile } from '../../model/tool_profile';
import type { ToolInfo } from '../../wire/types';
import { commonScale, silhouette } from '../silhouette';
import { ProfileEditor } from './profile_editor';

export class ToolRack {
  /** The tool whose outline is edited; null: none. */
  readonly edited = signal<number | null>(null);
  private readonly tools_;

  constructor(tools: readonly ToolInfo[]) {
    this.tools_ = signal(tools);
  }

  /** The tools, as a signal's value. */
  get tools(): readonly ToolInfo[] {
    return this.tools_.value;
  }

  add(): void {
    const tool = newTool(this.tools);
    this.tools_.value = [...this.tools, tool];
    this.edited.value = tool.id;
  }

  /** Takes the place of the tool with the same number. */
  replace(tool: ToolInfo): void {
    this.tools_.value = this.tools.map((one) => (one.id === tool.id ? tool : one));
  }

  remove(id: number): void {
    if (this.edited.peek() === id) this.edited.value = null;
    this.tools_.value = this.tools.filter((tool) => tool.id !== id);
  }
}

interface ItemProps {
  rack: ToolRack;
  tool: ToolInfo;
  /** As SVG; its text is made of numbers. */
  drawing: string;
}

function Item({ rack, tool, drawing }: ItemProps) {
  const name = `T${tool.id}, ${toolName(tool)}`;
  const isEdited = tool.id === rack.edited.value;
  return (
    <li>
      <button
        type="button"
        class="rack-tool"
        aria-label={t('Outline of {0}', name)}
        aria-pressed={isEdited}
        disabled={pointsOf(tool) === null}
        onClick={() => (rack.edited.value = isEdited ? null : tool.id)}
      >
        <span style="display: contents" dangerouslySetInnerHTML={{ __html: drawing }} />
        <small>{name}</small>
      </button>
      <button
        type="button"
        class="button quiet-button"
        aria-label={t('Remove {0}', name)}
        disabled={rack.tools.length === 1}
        onClick={() => rack.remove(tool.id)}
      >
        {t('Remove')}
      </button>
    </li>
  );
}

export function ToolRackView({ rack }: { rack: ToolRack }) {
  const { tools } = rack;
  const profiles = tools.map((tool) => toolProfile(tool));
  const scale = commonScale(profiles);
  const edited = tools.find(({ id }) => id === rack.edited.value);
  return (
    <div class="tool-rack">
      <span class="field-name">{t('Tools')}</span>
      <ul class="rack-tools" aria-label={t('Tools')}>
        {tools.map((tool, n) => (
          <Item key={tool.id} rack={rack} tool={tool} drawing={silhouette(profiles[n]!, scale)} />
        ))}
      </ul>
      <div class="rack-editor">
        {edited && (
          <ProfileEditor key={edited.id} tool={edited} changed={(tool) => rack.replace(tool)} />
        )}
      </div>
      <button type="button" class="button quiet-button" onClick={() => rack.add()}>
        {t('Add a tool')}
      </button>
    </div>
  );
}
