// SPDX-License-Identifier: Apache-2.0
// Draws the block cut by a plane. Everything in front of the plane is clipped; the material in the
// plane is a hatched cap, drawn where a line of sight leaves the surface behind the plane once more
// than it enters (counted by parity in the stencil), with the outline of the section over it.

import * as THREE from 'three';
import type { Plane, Section } from '../../model/section';
import type { Bounds } from '../../model/session';
import type { Layer, Viewer } from '../viewer';

const CAP_VERTEX = /* glsl */ `
varying vec2 vPlace;
uniform float side;
void main() {
  vPlace = position.xy * side;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const CAP_FRAGMENT = /* glsl */ `
varying vec2 vPlace;
uniform float spacing;
void main() {
  float at = (vPlace.x + vPlace.y) / (1.41421356 * spacing);
  float width = fwidth(at);
  float line = 1.0 - smoothstep(0.0, 1.5 * width, abs(fract(at) - 0.5) - 0.06);
  gl_FragColor = vec4(mix(vec3(0.97, 0.80, 0.62), vec3(0.72, 0.36, 0.13), line), 1.0);
}`;

const HATCH_PX = 11;

/** The nearest of 1, 2, 5, 10, … */
function rounded(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [1, 2, 5, 10].find((step) => step * power >= value * 0.8) ?? 10;
  return digit * power;
}

export class SectionView implements Layer {
  private readonly clip_ = new THREE.Plane();
  private readonly counting_ = new THREE.MeshBasicMaterial({
    side: THREE.DoubleSide,
    colorWrite: false,
    depthWrite: false,
    depthTest: false,
    clippingPlanes: [this.clip_],
    stencilWrite: true,
    stencilWriteMask: 1,
    stencilFunc: THREE.AlwaysStencilFunc,
    stencilZPass: THREE.InvertStencilOp,
  });
  private readonly cap_ = new THREE.Mesh(
    new THREE.PlaneGeometry(1, 1),
    new THREE.ShaderMaterial({
      vertexShader: CAP_VERTEX,
      fragmentShader: CAP_FRAGMENT,
      uniforms: { side: { value: 1 }, spacing: { value: 1 } },
      side: THREE.DoubleSide,
      stencilWrite: true,
      stencilWriteMask: 0,
      stencilFuncMask: 1,
      stencilFunc: THREE.EqualStencilFunc,
      stencilRef: 1,
      polygonOffset: true, // behind its outline
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    }),
  );
  private readonly outline_ = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ color: '#5c2a0c' }),
  );
  private readonly counted_ = new THREE.Scene();
  private readonly caps_ = new THREE.Scene();
  private plane_: Plane | null = null;

  constructor(private readonly viewer: Viewer) {
    this.counted_.overrideMaterial = this.counting_;
    this.outline_.frustumCulled = false;
    this.outline_.renderOrder = 1;
    this.caps_.add(this.cap_, this.outline_);
    viewer.layers.add(this);
  }

  /** Cuts the block; null: shows all of it. */
  set(plane: Plane | null, bounds: Bounds): void {
    this.plane_ = plane;
    if (plane) {
      const normal = new THREE.Vector3(...plane.normal);
      this.clip_.normal.copy(normal).negate();
      this.clip_.constant = plane.offset;
      const min = new THREE.Vector3(...bounds.min);
      const max = new THREE.Vector3(...bounds.max);
      const side = 1.05 * min.distanceTo(max);
      this.clip_.projectPoint(min.add(max).multiplyScalar(0.5), this.cap_.position);
      this.cap_.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
      this.cap_.scale.set(side, side, 1);
      this.uniforms_['side']!.value = side;
    }
    this.viewer.stockMaterial.setClip(plane ? this.clip_ : null);
    this.viewer.touchAll();
  }

  setOutline({ lines }: Section): void {
    this.outline_.geometry.dispose();
    this.outline_.geometry = new THREE.BufferGeometry();
    this.outline_.geometry.setAttribute('position', new THREE.BufferAttribute(lines, 3));
    this.viewer.touch();
  }

  draw(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    if (!this.plane_) return;
    this.uniforms_['spacing']!.value = rounded(
      HATCH_PX * this.viewer.pixelMm(this.cap_.position) || 1,
    );
    const { group } = this.viewer.tiles;
    const home = group.parent;
    renderer.autoClear = false;
    this.counted_.add(group);
    renderer.render(this.counted_, camera);
    home?.add(group);
    renderer.render(this.caps_, camera);
    renderer.autoClear = true;
  }

  private get uniforms_(): Record<string, THREE.IUniform> {
    return this.cap_.material.uniforms;
  }
}
