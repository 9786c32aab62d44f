// SPDX-License-Identifier: Apache-2.0
// The others who carve: a hand of natural size at the handle of each tool, with the name.

import * as THREE from 'three';
import type { CarverViews, ShownCarver } from '../../view/carver_views';
import { HandView } from './hand_view';
import type { Placement } from './placement';

const AT_HANDLE = 0.85; // of the tool's height
const NAME_ABOVE_M = 0.09;
const NAME_MAX_M = 0.3; // from the tip: the name of a tool that is larger than the user is seen

export class Others {
  private readonly hands_ = new Map<number, { view: HandView; look: string }>();

  constructor(private readonly carvers: Pick<CarverViews, 'shown'>) {}

  /** How many hands there are. */
  get count(): number {
    return this.hands_.size;
  }

  /** Once a frame; `eye`: of the user, in the scene. */
  update({ scale, quaternion }: Placement, eye: THREE.Vector3): void {
    const up = new THREE.Vector3(0, 1, 0).applyQuaternion(quaternion.clone().invert());
    const present = new Set<number>();
    for (const carver of this.carvers.shown()) {
      present.add(carver.id);
      this.place_(carver, scale).face(eye, up);
    }
    for (const [id, { view }] of this.hands_) {
      if (present.has(id)) continue;
      view.dispose();
      this.hands_.delete(id);
    }
  }

  dispose(): void {
    for (const { view } of this.hands_.values()) view.dispose();
    this.hands_.clear();
  }

  private place_({ id, name, color, tool }: ShownCarver, scale: number): HandView {
    const look = `${color} ${name}`;
    let hand = this.hands_.get(id);
    if (hand?.look !== look) {
      hand?.view.dispose();
      hand = { view: new HandView(color, name), look };
      this.hands_.set(id, hand);
    }
    const { group } = hand.view;
    // In the tool's group, in which lengths are millimeters: another tool has another group.
    if (group.parent !== tool.group) tool.group.add(group);
    group.position.set(0, 0, AT_HANDLE * tool.topMm);
    group.scale.setScalar(1 / scale);
    hand.view.nameAt = Math.min(NAME_ABOVE_M, NAME_MAX_M - AT_HANDLE * tool.topMm * scale);
    return hand.view;
  }
}
