// SPDX-License-Identifier: Apache-2.0
// The light of a bright studio, as nine spherical harmonics. Rendering an environment map and
// filtering it, as three's PMREMGenerator does, blocks a page without a GPU for seconds.

import * as THREE from 'three';

/**
 * Radiance of three's RoomEnvironment, turned to Z up, as LightProbeGenerator projects it from a
 * cube of 64 pixels; red, green and blue are equal.
 */
const AMBIENT = [2.9382, -1.2114, 1.2269, 0.1198, 0.2235, -0.9635, 0.6063, 0.1917, -0.793] as const;

const MIRROR = /* glsl */ `
#include <lights_fragment_maps>
#if defined(USE_LIGHT_PROBES) && defined(RE_IndirectSpecular)
radiance += max(vec3(0.0), RECIPROCAL_PI *
  getLightProbeIrradiance(lightProbe, reflect(-geometryViewDir, geometryNormal)));
#endif
`;

/** Diffuse light of the studio; `intensity` 1 is its own. */
export function ambientLight(intensity: number): THREE.LightProbe {
  const harmonics = new THREE.SphericalHarmonics3();
  for (const [n, value] of AMBIENT.entries()) harmonics.coefficients[n]!.setScalar(value);
  return new THREE.LightProbe(harmonics, intensity);
}

/**
 * Returns the shader of a standard material that also mirrors the studio: blurred, as nine harmonics
 * are, which suits surfaces that are not polished.
 */
export function withMirroredLight(fragmentShader: string): string {
  return fragmentShader.replace('#include <lights_fragment_maps>', MIRROR);
}

/** Lets a material mirror the studio. */
export function mirrorAmbient<T extends THREE.Material>(material: T): T {
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = withMirroredLight(shader.fragmentShader);
  };
  return material;
}
