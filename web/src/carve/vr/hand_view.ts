// SPDX-License-Identifier: Apache-2.0
// A fist around the Z axis, in meters: the user's own hands, and those of the others with their names.

import * as THREE from 'three';
import { mirrorAmbient } from '../../view/ambient_light';

const FINGERS = 4;
const FINGER_RADIUS_M = 0.009;
const CURL_RADIUS_M = 0.02;
const NAME_HEIGHT_M = 0.035;
const NAME_PX = 64;

/** Four curled fingers and a palm, of which each is a part of a ring around the handle. */
function fist(material: THREE.Material): THREE.Mesh[] {
  const finger = new THREE.TorusGeometry(CURL_RADIUS_M, FINGER_RADIUS_M, 8, 16, 1.45 * Math.PI);
  const fingers = Array.from({ length: FINGERS }, (_, n) => {
    const mesh = new THREE.Mesh(finger, material);
    mesh.position.z = (n - (FINGERS - 1) / 2) * 1.9 * FINGER_RADIUS_M;
    return mesh;
  });
  const thumb = new THREE.Mesh(
    new THREE.CapsuleGeometry(FINGER_RADIUS_M, 0.03, 4, 8).rotateX(Math.PI / 2),
    material,
  );
  thumb.position.set(0, CURL_RADIUS_M, -0.045);
  return [...fingers, thumb];
}

type Plate = THREE.Mesh<THREE.PlaneGeometry, THREE.MeshBasicMaterial>;

/** A plate, because three's sprites have no size in a scene of other units than the eyes'. */
function namePlate(name: string, color: string): Plate {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d')!;
  const font = `600 ${NAME_PX * 0.6}px Inter, sans-serif`;
  context.font = font;
  canvas.width = Math.ceil(context.measureText(name).width) + NAME_PX;
  canvas.height = NAME_PX;
  context.fillStyle = color;
  context.beginPath();
  context.roundRect(0, 0, canvas.width, NAME_PX, NAME_PX / 2);
  context.fill();
  context.font = font;
  context.fillStyle = '#fff';
  context.textBaseline = 'middle';
  context.fillText(name, NAME_PX / 2, NAME_PX / 2);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const width = (NAME_HEIGHT_M * canvas.width) / NAME_PX;
  return new THREE.Mesh(
    new THREE.PlaneGeometry(width, NAME_HEIGHT_M),
    new THREE.MeshBasicMaterial({ map, transparent: true, depthTest: false, toneMapped: false }),
  );
}

export class HandView {
  readonly group = new THREE.Group();
  private readonly material_: THREE.MeshStandardMaterial;
  private readonly fist_: THREE.Mesh[];
  private readonly plate_: Plate | null;

  /** `name`: is shown above the hand; empty: one's own. */
  constructor(color: string, name = '') {
    this.material_ = mirrorAmbient(new THREE.MeshStandardMaterial({ color, roughness: 0.6 }));
    this.fist_ = fist(this.material_);
    this.group.add(...this.fist_);
    this.plate_ = name === '' ? null : namePlate(name, color);
    if (this.plate_) this.group.add(this.plate_);
  }

  /** How far the name is from the hand along the handle, m. */
  set nameAt(alongM: number) {
    this.plate_?.position.set(0, 0, alongM);
  }

  /** Turns the name to an eye; `up`: in the picture. Both in the scene. */
  face(eye: THREE.Vector3, up: THREE.Vector3): void {
    this.plate_?.up.copy(up);
    this.plate_?.lookAt(eye);
  }

  dispose(): void {
    for (const part of this.fist_) part.geometry.dispose();
    this.material_.dispose();
    this.plate_?.geometry.dispose();
    this.plate_?.material.map?.dispose();
    this.plate_?.material.dispose();
    this.group.removeFromParent();
  }
}
