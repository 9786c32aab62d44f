// SPDX-License-Identifier: Apache-2.0
// The light of a bright room, as nine spherical harmonics. Rendering an environment map and
// filtering it, as three's PMREMGenerator does, blocks a page without a GPU for seconds.

import * as THREE from 'three';

/**
 * Radiance of three's RoomEnvironment, turned to Z up, as LightProbeGenerator projects it from a
 * cube of 64 pixels; red, green and blue are equal.
 */
const ROOM = [2.9382, -1.2114, 1.2269, 0.1198, 0.2235, -0.9635, 0.6063, 0.1917, -0.793] as const;

const MIRROR = /* glsl */ `
#include <lights_fragment_maps>
#if defined(USE_LIGHT_PROBES) && defined(RE_IndirectSpecular)
radiance += max(vec3(0.0), RECIPROCAL_PI *
  getLightProbeIrradiance(lightProbe, reflect(-geometryViewDir, geometryNormal)));
#endif
`;

/** Diffuse light of the room; `intensity` 1 is the room's own. */
export function roomLight(intensity: number): THREE.LightProbe {
  const harmonics = new THREE.SphericalHarmonics3();
  for (const [n, value] of ROOM.entries()) harmonics.coefficients[n]!.setScalar(value);
  return new THREE.LightProbe(harmonics, intensity);
}

/**
 * Returns the shader of a standard material that also mirrors the room: blurred, as nine harmonics
 * are, which suits surfaces that are not polished.
 */
export function withMirroredRoom(fragmentShader: string): string {
  return fragmentShader.replace('#include <lights_fragment_maps>', MIRROR);
}

/** Lets a material mirror the room. */
export function mirrorRoom<T extends THREE.Material>(material: T): T {
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = withMirroredRoom(shader.fragmentShader);
  };
  return material;
}
