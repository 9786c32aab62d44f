// SPDX-License-Identifier: Apache-2.0
// Glass for one's own tool: seen through where it faces the viewer, and opaque at its outline, so
// that it hides no cut.

import * as THREE from 'three';

const VERTEX = /* glsl */ `
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  vNormal = normalMatrix * normal;
  vToEye = isOrthographic ? vec3(0.0, 0.0, 1.0) : -at.xyz;
  gl_Position = projectionMatrix * at;
}
`;
/** From the face to the edge: clear, a band of white, and the color, so that any block sets it off. */
const FRAGMENT = /* glsl */ `
uniform vec3 color;
uniform float facing;
uniform float outline;
varying vec3 vNormal;
varying vec3 vToEye;
void main() {
  float across = 1.0 - abs(dot(normalize(vNormal), normalize(vToEye)));
  float band = smoothstep(0.3, 0.55, across);
  float edge = smoothstep(0.55, 0.8, across);
  gl_FragColor = vec4(mix(vec3(1.0), color, edge), mix(facing, outline, 0.45 * band + 0.55 * edge));
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;

/** @param facing, outline opacity of a face that faces the viewer, and of one seen from its edge. */
export function ghostMaterial(
  color: string,
  facing: number,
  outline: number,
): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    uniforms: {
      color: { value: new THREE.Color(color) },
      facing: { value: facing },
      outline: { value: outline },
    },
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    transparent: true,
    depthWrite: false,
    side: THREE.DoubleSide, // the outline is whole from above
  });
}
