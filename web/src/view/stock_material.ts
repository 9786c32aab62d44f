// SPDX-License-Identifier: Apache-2.0
// The block's material: three's standard material with two additions in the shader. Where the
// surface is that of the untouched stock, as the tiles say, it has the skin color, elsewhere the
// core color; and growth rings run through the solid.

import * as THREE from 'three';
import type { StockMaterialPreset } from '../model/materials';
import { ORIGINAL_ATTRIBUTE } from './parsed_tiles';
import { withMirroredLight } from './ambient_light';

const VERTEX_HEAD = /* glsl */ `
attribute float ${ORIGINAL_ATTRIBUTE};
varying float vStockOriginal;
varying vec3 vStockPosition;
varying vec3 vStockNormal;
`;

const VERTEX_BODY = /* glsl */ `
mat4 stockMatrix = modelMatrix;
#ifdef USE_INSTANCING
stockMatrix = modelMatrix * instanceMatrix;
#endif
vStockOriginal = ${ORIGINAL_ATTRIBUTE};
vStockPosition = (stockMatrix * vec4(transformed, 1.0)).xyz;
vStockNormal = normalize(mat3(stockMatrix) * objectNormal);
`;

const FRAGMENT_HEAD = /* glsl */ `
varying float vStockOriginal;
varying vec3 vStockPosition;
varying vec3 vStockNormal;
uniform vec3 stockMin;
uniform vec3 stockMax;
uniform vec3 stockSkin;
uniform vec3 stockCore;
uniform vec3 stockRing;
uniform float stockGrain;
uniform float stockDetail; // radius of curvature of a fully shaded valley, mm
uniform float stockCurvature; // 1: colors show the curvature

// Growth rings of a log whose pith is outside the block, unevenly spaced; they fade where they
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
float stockOuter = smoothstep(0.4, 0.6, vStockOriginal);
float stockRings = stockGrain > 0.0 ? growthRing(vStockPosition) * stockGrain : 0.0;
vec3 stockInner = mix(stockCore, stockRing, stockRings * 0.5);
vec3 stockOuterColor = stockSkin * (1.0 - 0.22 * stockRings);
diffuseColor.rgb = mix(stockInner, stockOuterColor, stockOuter);
// Darkens valleys and deep cut surfaces, brightens ridges.
float stockRidge = ridge(vStockPosition, stockNormal) * stockDetail;
float stockRelief = clamp(stockRidge, -1.0, 0.6);
float stockDepth = (stockMax.z - vStockPosition.z) / (stockMax.z - stockMin.z);
float stockSky = 1.0 - 0.22 * smoothstep(0.0, 0.6, stockDepth) * (1.0 - stockOuter);
diffuseColor.rgb *= stockSky * (1.0 + 0.42 * stockRelief);
// Hollow blue, raised red; full color at six times the radius of a fully shaded valley.
float stockBend = clamp(6.0 * stockRidge, -1.0, 1.0);
vec3 stockBent = stockBend < 0.0 ? vec3(0.03, 0.13, 0.62) : vec3(0.62, 0.05, 0.03);
diffuseColor.rgb =
    mix(diffuseColor.rgb, mix(vec3(0.62), stockBent, abs(stockBend)), stockCurvature);
`;

/** The material shared by all tiles of one block. */
export class StockMaterial {
  readonly material = new THREE.MeshStandardMaterial({ side: THREE.FrontSide });
  private readonly uniforms_ = {
    stockMin: { value: new THREE.Vector3() },
    stockMax: { value: new THREE.Vector3(1, 1, 1) },
    stockSkin: { value: new THREE.Color() },
    stockCore: { value: new THREE.Color() },
    stockRing: { value: new THREE.Color() },
    stockGrain: { value: 0 },
    stockDetail: { value: 1 },
    stockCurvature: { value: 0 },
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

  setBounds(pitchMm: number, min: THREE.Vector3, max: THREE.Vector3): void {
    this.uniforms_.stockMin.value.copy(min);
    this.uniforms_.stockMax.value.copy(max);
    this.uniforms_.stockDetail.value = Math.max(2.5 * pitchMm, min.distanceTo(max) / 90);
  }

  /** Hides everything in front of a plane; null hides nothing. */
  setClip(plane: THREE.Plane | null): void {
    this.material.clippingPlanes = plane ? [plane] : null;
    this.material.clipShadows = true;
  }

  /** Colors show the curvature instead of the material. */
  set curvature(shown: boolean) {
    this.uniforms_.stockCurvature.value = shown ? 1 : 0;
  }

  /** The greatest radius of curvature, mm, at which the color is full. */
  get curvatureMm(): number {
    return 6 * this.uniforms_.stockDetail.value;
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
