// SPDX-License-Identifier: Apache-2.0
// The block's material: three's standard material with two additions in the shader. Where a surface still lies on the stock's
// original outside it has the skin's colour, elsewhere the core's; and year rings run through the solid.

import * as THREE from 'three';
import type { StockLook } from '../model/materials';
import type { Stock } from '../wire/types';

const VERTEX_HEAD = /* glsl */ `
varying vec3 vStockPosition;
varying vec3 vStockNormal;
`;

const VERTEX_BODY = /* glsl */ `
vStockPosition = (modelMatrix * vec4(transformed, 1.0)).xyz;
vStockNormal = normalize(mat3(modelMatrix) * objectNormal);
`;

const FRAGMENT_HEAD = /* glsl */ `
varying vec3 vStockPosition;
varying vec3 vStockNormal;
uniform vec3 stockMin;
uniform vec3 stockMax;
uniform vec3 stockReach; // how near to the outside still counts as outside, mm: sides (x, y), ends (z)
uniform float stockRound; // radius of a cylinder, 0 for a box
uniform vec3 stockSkin;
uniform vec3 stockCore;
uniform vec3 stockRing;
uniform float stockGrain;
uniform float stockDetail; // radius of curvature that counts as a sharp valley, mm

float onFace(float distanceMm, float reach, float facing) {
  return (1.0 - smoothstep(reach, reach * 1.6, distanceMm)) * smoothstep(0.55, 0.8, facing);
}

float stockOutside(vec3 p, vec3 n) {
  float ends = max(onFace(abs(stockMax.z - p.z), stockReach.z, n.z), onFace(abs(p.z - stockMin.z), stockReach.z, -n.z));
  if (stockRound > 0.0) {
    vec2 fromAxis = p.xy - 0.5 * (stockMin.xy + stockMax.xy);
    float r = length(fromAxis);
    return max(ends, onFace(abs(stockRound - r), stockReach.x * 1.4, dot(n.xy, fromAxis / max(r, 1e-6))));
  }
  float x = max(onFace(abs(stockMax.x - p.x), stockReach.x, n.x), onFace(abs(p.x - stockMin.x), stockReach.x, -n.x));
  float y = max(onFace(abs(stockMax.y - p.y), stockReach.y, n.y), onFace(abs(p.y - stockMin.y), stockReach.y, -n.y));
  return max(ends, max(x, y));
}

// Year rings of a log whose pith lies beside the block, uneven as years are; they fade where they would be finer than a pixel.
float yearRing(vec3 p) {
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

// Mean curvature along the screen's axes, 1/mm: positive on ridges, negative in valleys.
float ridge(vec3 p, vec3 n) {
  vec3 px = dFdx(p);
  vec3 py = dFdy(p);
  return 0.5 * (dot(dFdx(n), px) / max(dot(px, px), 1e-9) + dot(dFdy(n), py) / max(dot(py, py), 1e-9));
}
`;

const FRAGMENT_COLOR = /* glsl */ `
vec3 stockNormal = normalize(vStockNormal);
float stockOuter = stockOutside(vStockPosition, stockNormal);
float stockYears = stockGrain > 0.0 ? yearRing(vStockPosition) * stockGrain : 0.0;
vec3 stockInner = mix(stockCore, stockRing, stockYears * 0.5);
vec3 stockOuterColor = stockSkin * (1.0 - 0.22 * stockYears);
diffuseColor.rgb = mix(stockInner, stockOuterColor, stockOuter);
// Valleys collect shade, ridges are worn bright, and what lies deep sees less of the sky.
float stockRelief = clamp(ridge(vStockPosition, stockNormal) * stockDetail, -1.0, 0.6);
float stockDepth = (stockMax.z - vStockPosition.z) / (stockMax.z - stockMin.z);
float stockSky = 1.0 - 0.22 * smoothstep(0.0, 0.6, stockDepth) * (1.0 - stockOuter);
diffuseColor.rgb *= stockSky * (1.0 + 0.42 * stockRelief);
`;

/** A material for all tiles of one block. */
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
      shader.vertexShader = VERTEX_HEAD + shader.vertexShader.replace('#include <fog_vertex>', VERTEX_BODY);
      shader.fragmentShader =
        FRAGMENT_HEAD + shader.fragmentShader.replace('#include <color_fragment>', FRAGMENT_COLOR);
    };
  }

  setStock(stock: Stock, pitchMm: number, min: THREE.Vector3, max: THREE.Vector3): void {
    this.uniforms_.stockMin.value.copy(min);
    this.uniforms_.stockMax.value.copy(max);
    this.uniforms_.stockRound.value = stock.shape === 'cylinder' ? stock.radius_mm : 0;
    this.uniforms_.stockDetail.value = Math.max(2.5 * pitchMm, min.distanceTo(max) / 90);
    // Walls of the mesh stand up to a column beside the true side; its top and bottom are exact.
    this.uniforms_.stockReach.value.set(1.1 * pitchMm, 1.1 * pitchMm, 0.04 * pitchMm);
  }

  setLook(look: StockLook): void {
    this.uniforms_.stockSkin.value.set(look.skin);
    this.uniforms_.stockCore.value.set(look.core);
    this.uniforms_.stockRing.value.set(look.ring);
    this.uniforms_.stockGrain.value = look.grain;
    this.material.roughness = look.roughness;
    this.material.metalness = look.metalness;
  }
}
