// SPDX-License-Identifier: Apache-2.0
// Objects with the materials that appear later: of a tool with a holder, of the arrows, and of
// their shadow map. Compiled with the block's before the first picture, they keep the first tool
// from stopping the page while the browser compiles. They are never drawn.

import * as THREE from 'three';
import { ToolView } from './tool_view';
import { WrenchView } from './wrench_view';

/** Which sides the shadow map gets of a material (WebGLShadowMap of three.js). */
const SHADOW_SIDES = {
  [THREE.FrontSide]: THREE.BackSide,
  [THREE.BackSide]: THREE.FrontSide,
  [THREE.DoubleSide]: THREE.DoubleSide,
} as const;

const HELD_TOOL = {
  id: 0,
  shape: 'ball',
  diameter_mm: 1,
  length_mm: 1,
  holder: [{ diameter_mm: 2, length_mm: 1 }],
};

/** A tool and its arrows, as carvers have them. */
export function carverSample(): THREE.Group {
  const sample = new THREE.Group();
  const tool = new ToolView(HELD_TOOL, '#808080', 1);
  return sample.add(tool.group, new WrenchView().group);
}

/** Returns the parts of an object as the shadow map draws them: by their depth. */
export function shadowSample(object: THREE.Object3D): THREE.Group {
  const sample = new THREE.Group();
  object.traverse((part) => {
    if (!(part instanceof THREE.Mesh) || !part.castShadow) return;
    const { geometry, material } = part as THREE.Mesh<THREE.BufferGeometry, THREE.Material>;
    const depth = new THREE.MeshDepthMaterial({ side: SHADOW_SIDES[material.side] });
    sample.add(new THREE.Mesh(geometry, depth));
  });
  return sample;
}
