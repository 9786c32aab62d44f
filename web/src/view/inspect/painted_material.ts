// SPDX-License-Identifier: Apache-2.0
// The material of a surface whose colors show signed values: gray within a tolerance, blue below it
// and red above it, full at the range.

import * as THREE from 'three';

/** The value of a vertex. */
export const VALUE_ATTRIBUTE = 'paintedValue';

const VERTEX_HEAD = /* glsl */ `
attribute float ${VALUE_ATTRIBUTE};
varying float vPaintedValue;
`;

const FRAGMENT_HEAD = /* glsl */ `
varying float vPaintedValue;
uniform float paintedTolerance;
uniform float paintedRange;
`;

// As colorOf() in model/deviation.ts, in linear light.
const FRAGMENT_COLOR = /* glsl */ `
float paintedBeyond =
    (abs(vPaintedValue) - paintedTolerance) / (paintedRange - paintedTolerance);
vec3 paintedEnd = vPaintedValue < 0.0 ? vec3(0.015, 0.09, 0.55) : vec3(0.55, 0.025, 0.013);
float paintedShare = paintedBeyond <= 0.0 ? 0.0 : 0.5 + 0.5 * min(1.0, paintedBeyond);
diffuseColor.rgb = mix(vec3(0.56, 0.58, 0.56), paintedEnd, paintedShare);
`;

export class PaintedMaterial {
  readonly material = new THREE.MeshLambertMaterial({
    // Over the tiles of which it is made.
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -4,
  });
  private readonly uniforms_ = {
    paintedTolerance: { value: 0 },
    paintedRange: { value: 1 },
  };

  constructor() {
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms_);
      shader.vertexShader =
        VERTEX_HEAD +
        shader.vertexShader.replace('#include <fog_vertex>', `vPaintedValue = ${VALUE_ATTRIBUTE};`);
      shader.fragmentShader =
        FRAGMENT_HEAD + shader.fragmentShader.replace('#include <color_fragment>', FRAGMENT_COLOR);
    };
  }

  setScale(tolerance: number, range: number): void {
    this.uniforms_.paintedTolerance.value = tolerance;
    this.uniforms_.paintedRange.value = range;
  }
}
