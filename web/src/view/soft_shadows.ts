// SPDX-License-Identifier: Apache-2.0
// Takes one sample of the shadow map for each pixel where the light's radius is 0. three.js takes
// five at any radius, which is slow on a CPU. The five are turned by a constant matrix instead of a
// sine and a cosine for each.

import { ShaderChunk } from 'three';

const SAMPLES = 5;
const GOLDEN_ANGLE = 2.399963229728653;

/** three's code in getShadow() for shadow maps of the type PCF. */
const FIVE_SAMPLES = /float phi = interleavedGradientNoise\([^;]*;\s*shadow = \([^;]*\) \* 0\.2;/;

// A loop, whose samples a CPU skips.
const SAMPLED = /* glsl */ `
int samples = shadowRadius > 0.0 ? ${SAMPLES} : 1;
float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
vec2 direction = vec2( cos( phi ), sin( phi ) );
shadow = 0.0;
for ( int n = 0; n < samples; ++ n ) {
  vec2 offset = direction * sqrt( ( float( n ) + 0.5 ) / ${SAMPLES}.0 ) * radius;
  shadow += texture( shadowMap, vec3( shadowCoord.xy + offset, shadowCoord.z ) );
  direction = mat2( ${matrix(GOLDEN_ANGLE)} ) * direction;
}
shadow /= float( samples );`;

/** A turn by an angle, as the values of a matrix of GLSL. */
function matrix(angle: number): string {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [cos, sin, -sin, cos].map((value) => value.toFixed(9)).join(', ');
}

/** Returns three's functions for shadows, with as many samples as the light's radius needs. */
export function withFewerSamples(shadowFunctions: string): string {
  return shadowFunctions.replace(FIVE_SAMPLES, SAMPLED);
}

/** From now on all materials take as many samples as the light's radius needs. */
export function adaptShadows(): void {
  ShaderChunk.shadowmap_pars_fragment = withFewerSamples(ShaderChunk.shadowmap_pars_fragment);
}
