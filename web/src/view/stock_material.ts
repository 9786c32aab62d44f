// SPDX-License-Identifier: Apache-2.0
// The block's material: three's standard material with two additions in the shader. Fragments on
// the stock's original outside get the skin color, all others the core color, and growth rings run
// through the solid.

import * as THREE from 'three';
import type { StockMaterialPreset } from '../model/materials';
import type { Stock } from '../wire/types';
import { withMirroredLight } from './ambient_light';

const VERTEX_HEAD = /* glsl */ `
varying vec3 vStockPosition;
varying vec3 vStockNormal;
`;

const VERTEX_BODY = /* glsl */ `
mat4 stockMatrix = modelMatrix;
#ifdef USE_INSTANCING
stockMatrix = modelMatrix * instanceMatrix;
#endif
vStockPosition = (stockMatrix * vec4(transformed, 1.0)).xyz;
vStockNormal = normalize(mat3(stockMatrix) * objectNormal);
`;

const FRAGMENT_HEAD = /* glsl */ `
varying vec3 vStockPosition;
varying vec3 vStockNormal;
uniform vec3 stockMin;
uniform vec3 stockMax;
uniform vec3 stockReach; // a fragment this near to a side (x, y) or end (z) is on it, mm
uniform float stockRound; // radius of a cylinder, 0 for a box
uniform vec3 stockSkin;
uniform vec3 stockCore;
uniform vec3 stockRing;
uniform float stockGrain;
uniform float stockDetail; // radius of curvature of a fully shaded valley, mm

float onFace(float distanceMm, float reach, float facing) {
  return (1.0 - smoothstep(reach, reach * 1.6, distanceMm)) * smoothstep(0.55, 0.8, facing);
}

vec3 onFaces(vec3 distanceMm, vec3 facing) {
  return vec3(
    onFace(distanceMm.x, stockReach.x, facing.x),
    onFace(distanceMm.y, stockReach.y, facing.y),
    onFace(distanceMm.z, stockReach.z, facing.z));
}

float stockOutside(vec3 p, vec3 n) {
  vec3 atMax = onFaces(abs(stockMax - p), n);
  vec3 atMin = onFaces(abs(p - stockMin), -n);
  float ends = max(atMax.z, atMin.z);
  if (stockRound > 0.0) {
    vec2 fromAxis = p.xy - 0.5 * (stockMin.xy + stockMax.xy);
    float r = length(fromAxis);
    float facing = dot(n.xy, fromAxis / max(r, 1e-6));
    return max(ends, onFace(abs(stockRound - r), stockReach.x * 1.4, facing));
  }
  return max(ends, max(max(atMax.x, atMin.x), max(atMax.y, atMin.y)));
}

// Growth rings of a log whose pith lies beside the block, unevenly spaced; they fade where they
// would be finer than a pixel.
float growthRing(vec3 p) {
  vec3 q = (p - 0.5 * (stockMin + stockMax)) / length(stockMax - stockMin);
  q += 0.020 * sin(q.yzx * 7.0 + vec3(0.3, 1.7, 2.9)) + 0.006 * sin(q.zxy * 19.0 + 1.1);
  float r = length((q.yz + vec2(0.42, 0.95)) * vec2(1.0, 1.25)) + 0.05 * q.x;
  float turns = r * 24.0 + 0.55 * sin(r * 23.0) + 0.35 * sin(r * 61.0);
  float phase = fract(turns);
  float late = smoothstep(0.05, 0.9, phase) * (1.0 - smoothstep(0.93, 1.0, phase));
  float fiber = dot(q, vec3(9.0, 420.0, 310.0)) + 4.0 * sin(q.x * 9.0);
  float blur = clamp(fwidth(turns) * 1.3, 0.0, 1.0);
  float fiberBlur = clamp(fwidth(fiber) * 0.5, 0.0, 1.0);
  return mix(late * late, 0.3, blur) * 0.85 + 0.15 * mix(0.5 + 0.5 * sin(fiber), 0.5, fiberBlur);
}

// Mean curvature along the screen axes, 1/mm: positive on ridges, negative in valleys.
float ridge(vec3 p, vec3 n) {
  vec3 px = dFdx(p);
  vec3 py = dFdy(p);
  float kx = dot(dFdx(n), px) / max(dot(px, px), 1e-9);
  float ky = dot(dFdy(n), py) / max(dot(py, py), 1e-9);
  return 0.5 * (kx + ky);
}
`;

const FRAGMENT_COLOR = /* glsl */ `
vec3 stockNormal = normalize(vStockNormal);
float stockOuter = stockOutside(vStockPosition, stockNormal);
float stockRings = stockGrain > 0.0 ? growthRing(vStockPosition) * stockGrain : 0.0;
vec3 stockInner = mix(stockCore, stockRing, stockRings * 0.5);
vec3 stockOuterColor = stockSkin * (1.0 - 0.22 * stockRings);
diffuseColor.rgb = mix(stockInner, stockOuterColor, stockOuter);
// Darkens valleys and deep cut surfaces, brightens ridges.
float stockRelief = clamp(ridge(vStockPosition, stockNormal) * stockDetail, -1.0, 0.6);
float stockDepth = (stockMax.z - vStockPosition.z) / (stockMax.z - stockMin.z);
float stockSky = 1.0 - 0.22 * smoothstep(0.0, 0.6, stockDepth) * (1.0 - stockOuter);
diffuseColor.rgb *= stockSky * (1.0 + 0.42 * stockRelief);
`;

/** The material shared by all tiles of one block. */
export class StockMaterial {
  readonly material = new THREE.MeshStandardMaterial({ side: THREE.FrontSide });
  private readonly uniforms_ = {
    stockMin: { value: new THREE.Vector3() },
    stockMax: { value: new THREE.Vector3(1, 1, 1) },
    stockReach: { value: new THREE.Vector3(0.1, 0.1, 0.01) },
    stockRound: { value: 0 },
    stockSkin: { value: new THREE.Color() },
    stockCore: { value: new THREE.Color() },
    stockRing: { value: new THREE.Color() },
    stockGrain: { value: 0 },
    stockDetail: { value: 1 },
  };

  constructor() {
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms_);
      shader.vertexShader =
        VERTEX_HEAD + shader.vertexShader.replace('#include <fog_vertex>', VERTEX_BODY);
      shader.fragmentShader =
        FRAGMENT_HEAD +
        withMirroredLight(shader.fragmentShader).replace(
          '#include <color_fragment>',
          FRAGMENT_COLOR,
        );
    };
  }

  setStock(stock: Stock, pitchMm: number, min: THREE.Vector3, max: THREE.Vector3): void {
    this.uniforms_.stockMin.value.copy(min);
    this.uniforms_.stockMax.value.copy(max);
    this.uniforms_.stockRound.value = stock.shape === 'cylinder' ? stock.radius_mm : 0;
    this.uniforms_.stockDetail.value = Math.max(2.5 * pitchMm, min.distanceTo(max) / 90);
    // The mesh's side walls are up to one column off the true side; its top and bottom are exact.
    this.uniforms_.stockReach.value.set(1.1 * pitchMm, 1.1 * pitchMm, 0.04 * pitchMm);
  }

  /** Hides what is in front of a plane; null: nothing. */
  setClip(plane: THREE.Plane | null): void {
    this.material.clippingPlanes = plane ? [plane] : null;
    this.material.clipShadows = true;
  }

  setPreset(preset: StockMaterialPreset): void {
    this.uniforms_.stockSkin.value.set(preset.skin);
    this.uniforms_.stockCore.value.set(preset.core);
    this.uniforms_.stockRing.value.set(preset.ring);
    this.uniforms_.stockGrain.value = preset.grain;
    this.material.roughness = preset.roughness;
    this.material.metalness = preset.metalness;
  }
}
