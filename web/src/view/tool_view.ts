// SPDX-License-Identifier: Apache-2.0
// A participant's tool: cutter, shank and holder as the scene defines them, with a collar and a
// translucent handle in the participant's color above. The group's origin is the tool's tip, its +Z
// the tool's axis.

import * as THREE from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { toolProfile } from '../model/tool_profile';
import type { OutlinePoint, ToolProfile } from '../model/tool_profile';
import type { ToolInfo, Vec3 } from '../wire/types';
import { mirrorAmbient } from './ambient_light';

type Drawable = THREE.Object3D & { geometry: THREE.BufferGeometry; material: THREE.Material };

const ROUND_SEGMENTS = 48;
const UP = new THREE.Vector3(0, 0, 1);

/** The surface of revolution of a tool's outline. */
export function lathe(pieces: OutlinePoint[][]): THREE.BufferGeometry {
  const parts = pieces.map(
    (piece) =>
      new THREE.LatheGeometry(
        piece.map(([r, z]) => new THREE.Vector2(r, z)),
        ROUND_SEGMENTS,
      ),
  );
  const merged = mergeGeometries(parts);
  for (const part of parts) part.dispose();
  return merged.rotateX(Math.PI / 2); // LatheGeometry turns about Y
}

const axisOf = new THREE.Vector3();

/** Puts an object with its origin at a tool's tip and its +Z along the tool's axis. */
export function setPose(object: THREE.Object3D, tip: Readonly<Vec3>, axis: Readonly<Vec3>): void {
  object.position.set(...tip);
  object.quaternion.setFromUnitVectors(UP, axisOf.set(...axis));
}

function cylinder(radius: number, z0: number, z1: number): OutlinePoint[][] {
  return [
    [
      [0, z0],
      [radius, z0],
    ],
    [
      [radius, z0],
      [radius, z1],
    ],
    [
      [radius, z1],
      [0, z1],
    ],
  ];
}

export class ToolView {
  readonly group = new THREE.Group();
  profile: ToolProfile;
  /** Height of the handle's top above the tip, mm; the name is above it. */
  readonly topMm: number;

  /** Height of the handle's top of a tool that is drawn, mm. */
  static topMm(tool: ToolInfo, pivotMm: number): number {
    const length = toolProfile(tool).body.topMm;
    return Math.max(length * 1.35, length + 18, pivotMm);
  }

  constructor(tool: ToolInfo, color: string, pivotMm: number) {
    this.profile = toolProfile(tool);
    const { topRadiusMm: radius, body } = this.profile;
    // Collar and handle, which are not part of the scene, start above its parts.
    const length = body.topMm;
    this.topMm = ToolView.topMm(tool, pivotMm);
    const collarRadius = radius * 1.25 + 0.8;
    const collarTop = length + Math.max(2.5, radius * 0.5);
    this.group.add(
      this.part_(
        this.profile.pieces,
        new THREE.MeshStandardMaterial({
          color: '#e8edf2',
          metalness: 0.6,
          roughness: 0.28,
          side: THREE.DoubleSide,
        }),
      ),
      this.part_(
        cylinder(collarRadius, length, collarTop),
        new THREE.MeshStandardMaterial({
          color,
          metalness: 0.05,
          roughness: 0.45,
        }),
      ),
    );
    if (body.pieces.length > 0) {
      this.group.add(
        this.part_(
          body.pieces,
          new THREE.MeshStandardMaterial({
            color: '#5d6670',
            metalness: 0.5,
            roughness: 0.5,
            side: THREE.DoubleSide,
          }),
        ),
      );
    }
    const handle = this.part_(
      cylinder(collarRadius * 0.92, collarTop, this.topMm),
      new THREE.MeshStandardMaterial({
        color,
        transparent: true,
        opacity: 0.26,
        roughness: 0.3,
        depthWrite: false,
      }),
    );
    handle.castShadow = false;
    handle.renderOrder = 2;
    this.group.add(handle, this.spindleLine_(color));
  }

  setPose(tip: readonly [number, number, number], axis: readonly [number, number, number]): void {
    setPose(this.group, tip, axis);
  }

  dispose(): void {
    this.group.traverse((object) => {
      if (!(object instanceof THREE.Mesh || object instanceof THREE.Line)) return;
      const { geometry, material } = object as Drawable;
      geometry.dispose();
      material.dispose();
    });
    this.group.removeFromParent();
  }

  private part_(pieces: OutlinePoint[][], material: THREE.Material): THREE.Mesh {
    const mesh = new THREE.Mesh(lathe(pieces), mirrorAmbient(material));
    // No receiveShadow: on thin round parts the shadow map's aliasing would be visible.
    mesh.castShadow = true;
    return mesh;
  }

  private spindleLine_(color: string): THREE.Line {
    const geometry = new THREE.BufferGeometry().setFromPoints([
      new THREE.Vector3(0, 0, this.topMm),
      new THREE.Vector3(0, 0, this.topMm * 1.25),
    ]);
    return new THREE.Line(
      geometry,
      new THREE.LineBasicMaterial({ color, transparent: true, opacity: 0.6 }),
    );
  }
}
