// SPDX-License-Identifier: Apache-2.0
// The symmetry of the hand in the view: its plane or axis, and a tool of glass at each image.

import { stockBounds } from '../model/session';
import { GhostTool } from '../view/ghost_tool';
import { MirrorView } from '../view/mirror_view';
import type { Viewer } from '../view/viewer';
import type { ToolInfo, Welcome } from '../wire/types';
import { imagesOf, middleOf } from './mirror';
import type { Mirror } from './mirror';
import type { Image, Pose } from './tool/path_queue';

export class Images {
  images: readonly Image[] = [];
  private mirror_: Mirror = 'off';
  private readonly view_ = new MirrorView();
  private tools_: GhostTool[] = [];
  private made_: { tool: ToolInfo; color: string; welcome: Welcome } | null = null;

  constructor(private readonly viewer: Viewer) {}

  get mirror(): Mirror {
    return this.mirror_;
  }

  set mirror(mirror: Mirror) {
    this.mirror_ = mirror;
    this.make_();
  }

  /** Another tool, or another block. */
  takeTool(tool: ToolInfo, color: string, welcome: Welcome): void {
    this.made_ = { tool, color, welcome };
    this.make_();
  }

  /** Whether plane or axis are shown: while the user carves. */
  set isShown(isShown: boolean) {
    const { scene } = this.viewer.stage;
    if (isShown) scene.add(this.view_.group);
    else this.view_.group.removeFromParent();
    this.viewer.touchAll();
  }

  place(pose: Pose): void {
    this.tools_.forEach((tool, n) => {
      const { tip, axis } = this.images[n]!(pose);
      tool.setPose(tip, axis);
      tool.group.visible = true;
    });
  }

  hide(): void {
    for (const { group } of this.tools_) group.visible = false;
  }

  private make_(): void {
    for (const tool of this.tools_) tool.dispose();
    this.tools_ = [];
    if (!this.made_) return;
    const { tool, color, welcome } = this.made_;
    const middle = middleOf(welcome);
    this.images = imagesOf(this.mirror_, middle);
    this.view_.show(
      this.mirror_ === 'off' ? null : this.mirror_,
      middle,
      stockBounds(welcome.stock),
    );
    this.tools_ = this.images.map(() => new GhostTool(tool, color, true));
    for (const { group } of this.tools_) this.viewer.stage.scene.add(group);
    this.viewer.touchAll();
  }
}
