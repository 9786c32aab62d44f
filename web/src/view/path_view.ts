// SPDX-License-Identifier: Apache-2.0
// Draws the path of an NC program as one geometry of lines: rapid moves dashed, the carved and the
// remaining part in different colors, the parts of one line of the text marked. Hidden parts shine
// through the block.

import * as THREE from 'three';
import { segmentsOf } from '../model/program_path';
import type { ProgramPath } from '../model/program_path';
import type { Vec3 } from '../wire/types';
import type { Layer, Viewer } from './viewer';

export const PATH_COLORS = {
  past: '#5b3fa8',
  future: '#00796b',
  rapid: '#b85c00',
  marked: '#d6006c',
} as const;

const VERTEX = /* glsl */ `
attribute float place;
attribute float rapid;
varying float vPlace;
varying float vRapid;
void main() {
  vPlace = place;
  vRapid = rapid;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= 1.0e-3 * gl_Position.w; // before the surface that it touches
}`;

const FRAGMENT = /* glsl */ `
varying float vPlace;
varying float vRapid;
uniform float reached;
uniform vec2 marked;
uniform float dash;
uniform float opacity;
uniform vec3 past;
uniform vec3 future;
uniform vec3 rapidColor;
uniform vec3 markedColor;
void main() {
  bool isPast = vPlace < reached + 0.5;
  bool isMarked = vPlace > marked.x - 0.5 && vPlace < marked.y + 0.5;
  bool isRapid = vRapid >= 0.0;
  if (isRapid && fract(vRapid / dash) > 0.55) discard;
  vec3 color = isMarked ? markedColor : isRapid ? rapidColor : isPast ? past : future;
  float alpha = isMarked ? max(opacity, 0.75) : isRapid && isPast ? 0.5 * opacity : opacity;
  gl_FragColor = vec4(color, alpha);
}`;

const DASH_PX = 9;

/** As it is written, since the shader's output is not converted. */
function colorOf(text: string): THREE.Vector3 {
  const { r, g, b } = new THREE.Color().setStyle(text, THREE.LinearSRGBColorSpace);
  return new THREE.Vector3(r, g, b);
}

export class PathView implements Layer {
  private readonly uniforms_ = {
    reached: { value: -1 },
    marked: { value: new THREE.Vector2(-2, -2) },
    dash: { value: 1 },
    past: { value: colorOf(PATH_COLORS.past) },
    future: { value: colorOf(PATH_COLORS.future) },
    rapidColor: { value: colorOf(PATH_COLORS.rapid) },
    markedColor: { value: colorOf(PATH_COLORS.marked) },
  };
  private readonly lines_ = [
    this.makeLines_(1, true), // in front of the block
    this.makeLines_(0.45, false), // also behind
  ];
  private readonly marker_ = document.createElement('div');
  private markerAt_: Vec3 | null = null;

  constructor(
    private readonly viewer: Viewer,
    overlay: HTMLElement,
  ) {
    this.marker_.className = 'path-marker';
    this.marker_.hidden = true;
    overlay.append(this.marker_);
    viewer.stage.scene.add(...this.lines_);
    viewer.layers.add(this);
  }

  /** null: draws none. */
  show(path: ProgramPath | null): void {
    const geometry = new THREE.BufferGeometry();
    if (path) {
      const { positions, places, rapids } = segmentsOf(path);
      geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
      geometry.setAttribute('place', new THREE.BufferAttribute(places, 1));
      geometry.setAttribute('rapid', new THREE.BufferAttribute(rapids, 1));
    }
    this.lines_[0]?.geometry.dispose();
    for (const lines of this.lines_) {
      lines.geometry = geometry;
      lines.visible = path !== null;
    }
    this.mark(null, null);
  }

  /** Up to which point the tool has come. */
  setReached(point: number): void {
    if (this.uniforms_.reached.value === point) return;
    this.uniforms_.reached.value = point;
    this.viewer.touch();
  }

  /** Marks the parts that lead to these points, and a place; null: none. */
  mark(points: [number, number] | null, at: Vec3 | null): void {
    this.uniforms_.marked.value.set(...(points ?? [-2, -2]));
    this.markerAt_ = at;
    this.viewer.touch();
  }

  drawn(camera: THREE.Camera, width: number, height: number): void {
    this.uniforms_.dash.value = DASH_PX * this.viewer.pixelMm(this.viewer.rig.controls.target);
    this.marker_.hidden = this.markerAt_ === null;
    if (!this.markerAt_) return;
    const seen = new THREE.Vector3(...this.markerAt_).project(camera);
    const x = (((seen.x + 1) / 2) * width).toFixed(1);
    const y = (((1 - seen.y) / 2) * height).toFixed(1);
    this.marker_.style.transform = `translate(-50%, -50%) translate(${x}px, ${y}px)`;
  }

  private makeLines_(opacity: number, depthTest: boolean): THREE.LineSegments {
    const lines = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        uniforms: { ...this.uniforms_, opacity: { value: opacity } },
        transparent: true,
        depthWrite: false,
        depthTest,
      }),
    );
    lines.frustumCulled = false;
    lines.visible = false;
    lines.renderOrder = 5;
    return lines;
  }
}
