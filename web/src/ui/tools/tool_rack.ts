// SPDX-License-Identifier: Apache-2.0
// The tools of a scene before it becomes a block: silhouettes, to be added, removed and given other
// outlines.

import { t } from '../../strings';
import '../style/tools.css';
import { newTool, pointsOf } from '../../model/profile_draft';
import { toolName, toolProfile } from '../../model/tool_profile';
import type { ToolInfo } from '../../wire/types';
import { h } from '../dom';
import { commonScale, silhouette } from '../silhouette';
import { ProfileEditor } from './profile_editor';

export class ToolRack {
  private readonly list_ = h('ul', { class: 'rack-tools', 'aria-label': t('Tools') });
  private readonly place_ = h('div', { class: 'rack-editor' });
  private readonly add_ = h(
    'button',
    { type: 'button', class: 'button quiet-button' },
    t('Add a tool'),
  );
  readonly element = h(
    'div',
    { class: 'tool-rack' },
    h('span', { class: 'field-name' }, t('Tools')),
    this.list_,
    this.place_,
    this.add_,
  );
  /** Of the tool whose outline is edited; null: of none. */
  private edited_: number | null = null;

  /** @param changed is called after each change of `tools` */
  constructor(
    private tools_: readonly ToolInfo[],
    private readonly changed: () => void,
  ) {
    this.add_.addEventListener('click', () => {
      const tool = newTool(this.tools_);
      this.set_([...this.tools_, tool]);
      this.edit_(tool.id);
    });
    this.draw_();
  }

  get tools(): readonly ToolInfo[] {
    return this.tools_;
  }

  private set_(tools: readonly ToolInfo[]): void {
    this.tools_ = tools;
    this.draw_();
    this.changed();
  }

  private edit_(id: number | null): void {
    this.edited_ = id;
    const tool = this.tools_.find((one) => one.id === id);
    this.place_.replaceChildren();
    if (tool)
      this.place_.append(
        new ProfileEditor(tool, (drawn) =>
          this.set_(this.tools_.map((one) => (one.id === drawn.id ? drawn : one))),
        ).element,
      );
    this.draw_();
  }

  private remove_(id: number): void {
    if (this.edited_ === id) this.edit_(null);
    this.set_(this.tools_.filter((tool) => tool.id !== id));
  }

  private draw_(): void {
    const profiles = this.tools_.map((tool) => toolProfile(tool));
    const scale = commonScale(profiles);
    const focused = (document.activeElement as HTMLElement | null)?.dataset['rack'];
    this.list_.replaceChildren(
      ...this.tools_.map((tool, n) => this.item_(tool, silhouette(profiles[n]!, scale))),
    );
    if (focused) this.list_.querySelector<HTMLElement>(`[data-rack="${focused}"]`)?.focus();
  }

  private item_(tool: ToolInfo, drawing: string): HTMLElement {
    const name = `T${tool.id}, ${toolName(tool)}`;
    const isEdited = tool.id === this.edited_;
    const edit = h('button', {
      type: 'button',
      class: 'rack-tool',
      'aria-label': t('Outline of {0}', name),
      'aria-pressed': String(isEdited),
      'data-rack': `edit ${tool.id}`,
    });
    edit.innerHTML = drawing; // numbers only
    edit.append(h('small', {}, name));
    edit.disabled = pointsOf(tool) === null;
    edit.addEventListener('click', () => this.edit_(isEdited ? null : tool.id));
    const remove = h(
      'button',
      {
        type: 'button',
        class: 'button quiet-button',
        'aria-label': t('Remove {0}', name),
        'data-rack': `remove ${tool.id}`,
      },
      t('Remove'),
    );
    remove.disabled = this.tools_.length === 1;
    remove.addEventListener('click', () => this.remove_(tool.id));
    return h('li', {}, edit, remove);
  }
}
