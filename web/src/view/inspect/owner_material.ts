// SPDX-License-Identifier: Apache-2.0
// The material of a surface that has one of some colors at each place.

import * as THREE from 'three';
import { VALUE_ATTRIBUTE } from './painted_material';

/** Colors at most; those beyond share the last one. */
export const SLOTS = 64;
const OTHERS = new THREE.Color(0.5, 0.5, 0.5);

const FRAGMENT_HEAD = /* glsl */ `
varying float vPaintedValue;
uniform vec3 ownerColors[${SLOTS}];
uniform int ownerAlone;
`;

const FRAGMENT_COLOR = /* glsl */ `
int ownerSlot = int(vPaintedValue + 0.5);
diffuseColor.rgb = ownerAlone < 0 || ownerAlone == ownerSlot ? ownerColors[ownerSlot] : vec3(0.5);
`;

export class OwnerMaterial {
  readonly material = new THREE.MeshLambertMaterial({
    // Over the tiles of which it is made.
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -4,
  });
  private readonly colors_ = Array.from({ length: SLOTS }, () => OTHERS.clone());
  private readonly alone_ = { value: -1 };

  constructor() {
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, {
        ownerColors: { value: this.colors_ },
        ownerAlone: this.alone_,
      });
      shader.vertexShader =
        `attribute float ${VALUE_ATTRIBUTE};\nvarying float vPaintedValue;\n` +
        shader.vertexShader.replace('#include <fog_vertex>', `vPaintedValue = ${VALUE_ATTRIBUTE};`);
      shader.fragmentShader =
        FRAGMENT_HEAD + shader.fragmentShader.replace('#include <color_fragment>', FRAGMENT_COLOR);
    };
  }

  /** @param color #rrggbb */
  setColor(slot: number, color: string): void {
    this.colors_[slot]?.set(color);
  }

  /** The others are gray; null: none is. */
  setAlone(slot: number | null): void {
    this.alone_.value = slot ?? -1;
  }
}
