// SPDX-License-Identifier: Apache-2.0
// The panel at the wrist of the hand without a tool: the tool, its force, and buttons that the other
// hand points at. In meters.

import * as THREE from 'three';
import { t } from '../../strings';
import { figure } from '../../ui/format';
import type { TriggerMode } from './tool_grip';
import type { Grip } from './placement';

export interface PanelState {
  tool: string;
  forceN: number;
  /** The force that fills the bar. */
  fullN: number;
  trigger: TriggerMode;
  /** The message; empty if there is none. */
  note: string;
}

export type PanelAction = 'undo' | 'redo' | 'before' | 'next' | 'trigger' | 'hand' | 'leave';

const [WIDTH, HEIGHT] = [640, 448];
const METERS_PER_PX = 0.2 / WIDTH;
const INK = '#17212b';
const PAPER = '#f7f8fa';
const BAR = { x: 32, y: 104, width: WIDTH - 64, height: 30 };
const ROWS: readonly [PanelAction, number, number, number][] = [
  ['before', 32, 160, 180],
  ['next', 230, 160, 180],
  ['hand', 428, 160, 180],
  ['undo', 32, 246, 279],
  ['redo', 329, 246, 279],
  ['trigger', 32, 332, 376],
  ['leave', 426, 332, 182],
];
const BUTTON_PX = 72;
const REACH_M = 1;

function label(action: PanelAction, trigger: TriggerMode): string {
  switch (action) {
    case 'undo':
      return t('Undo');
    case 'redo':
      return t('Redo');
    case 'before':
      return t('‹ Tool');
    case 'next':
      return t('Tool ›');
    case 'trigger':
      return trigger === 'cuts' ? t('Trigger cuts') : t('Trigger lifts');
    case 'hand':
      return t('Swap hands');
    case 'leave':
      return t('Leave');
  }
}

export class WristPanel {
  readonly mesh: THREE.Mesh<THREE.PlaneGeometry, THREE.MeshBasicMaterial>;
  private readonly context_: CanvasRenderingContext2D;
  private readonly texture_: THREE.CanvasTexture;
  private drawn_ = '';
  private pointed_: PanelAction | null = null;

  constructor() {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [WIDTH, HEIGHT];
    this.context_ = canvas.getContext('2d')!;
    this.texture_ = new THREE.CanvasTexture(canvas);
    this.texture_.colorSpace = THREE.SRGBColorSpace;
    this.mesh = new THREE.Mesh(
      new THREE.PlaneGeometry(WIDTH * METERS_PER_PX, HEIGHT * METERS_PER_PX),
      new THREE.MeshBasicMaterial({ map: this.texture_, toneMapped: false }),
    );
  }

  /** Above the wrist, turned to the user's eyes; null: the hand is not tracked. */
  place(grip: Grip | null): void {
    this.mesh.visible = grip !== null;
    if (!grip) return;
    this.mesh.quaternion
      .setFromAxisAngle(new THREE.Vector3(1, 0, 0), -0.28 * Math.PI)
      .premultiply(grip.quaternion);
    this.mesh.position.set(0, 0.1, 0.03).applyQuaternion(grip.quaternion).add(grip.position);
    this.mesh.updateMatrix();
  }

  /** The button that a hand points at, along the grip's -Z. */
  pointAt(grip: Grip | null): PanelAction | null {
    this.pointed_ = grip && this.mesh.visible ? this.actionUnder_(grip) : null;
    return this.pointed_;
  }

  draw(state: PanelState): void {
    const force = figure(state.forceN);
    const share = Math.min(1, state.forceN / Math.max(0.1, state.fullN));
    const text = [state.tool, force, share.toFixed(2), state.trigger, state.note, this.pointed_];
    if (this.drawn_ === text.join('|')) return;
    this.drawn_ = text.join('|');
    this.paint_(state, `${force} N`, share);
    this.texture_.needsUpdate = true;
  }

  dispose(): void {
    this.texture_.dispose();
    this.mesh.material.dispose();
    this.mesh.geometry.dispose();
    this.mesh.removeFromParent();
  }

  private actionUnder_(grip: Grip): PanelAction | null {
    const toPanel = this.mesh.matrix.clone().invert();
    const origin = grip.position.clone().applyMatrix4(toPanel);
    const direction = new THREE.Vector3(0, 0, -1)
      .applyQuaternion(grip.quaternion)
      .transformDirection(toPanel);
    const at = -origin.z / direction.z;
    if (direction.z >= 0 || !(at > 0 && at < REACH_M)) return null;
    const x = (origin.x + at * direction.x) / METERS_PER_PX + WIDTH / 2;
    const y = HEIGHT / 2 - (origin.y + at * direction.y) / METERS_PER_PX;
    const row = ROWS.find(
      ([, left, top, width]) => x >= left && x < left + width && y >= top && y < top + BUTTON_PX,
    );
    return row?.[0] ?? null;
  }

  private paint_(state: PanelState, force: string, share: number): void {
    const context = this.context_;
    context.fillStyle = PAPER;
    context.fillRect(0, 0, WIDTH, HEIGHT);
    context.textBaseline = 'middle';
    context.fillStyle = INK;
    context.font = '600 34px Inter, sans-serif';
    context.textAlign = 'left';
    context.fillText(state.tool, 32, 58, 380);
    context.textAlign = 'right';
    context.fillText(force, WIDTH - 32, 58, 180);
    context.fillStyle = '#d7dde4';
    context.fillRect(BAR.x, BAR.y, BAR.width, BAR.height);
    context.fillStyle = '#2563c9';
    context.fillRect(BAR.x, BAR.y, BAR.width * share, BAR.height);
    context.textAlign = 'center';
    context.font = '500 28px Inter, sans-serif';
    for (const [action, left, top, width] of ROWS) {
      context.fillStyle = action === this.pointed_ ? '#bcd2f5' : '#e6eaef';
      context.fillRect(left, top, width, BUTTON_PX);
      context.fillStyle = INK;
      const text = label(action, state.trigger);
      context.fillText(text, left + width / 2, top + BUTTON_PX / 2, width - 12);
    }
    context.font = '400 22px Inter, sans-serif';
    context.fillStyle = '#9a2d1c';
    context.fillText(state.note, WIDTH / 2, 426, WIDTH - 48);
  }
}
