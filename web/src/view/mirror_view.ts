// SPDX-License-Identifier: Apache-2.0
// Where strokes are repeated: a plane through the block, or an axis with as many rays as turns.

import * as THREE from 'three';
import type { Bounds } from '../model/session';
import type { Vec3 } from '../wire/types';

const MARGIN = 0.06; // around the block, of its longest side
const COLOR = '#7a6ff0';
const FILL = 0.09;
const EDGE = 0.75;

type Points = readonly Vec3[];

/** The corners of the plane across an axis, in order. */
function cornersOf(axis: 0 | 1 | 2, middle: Vec3, min: Vec3, max: Vec3): Points {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3] as [0 | 1 | 2, 0 | 1 | 2];
  const corner = (a: number, b: number): Vec3 => {
    const at: Vec3 = [...middle];
    [at[u], at[v]] = [a, b];
    return at;
  };
  return [
    corner(min[u], min[v]),
    corner(max[u], min[v]),
    corner(max[u], max[v]),
    corner(min[u], max[v]),
  ];
}

/** The axis, and a ray over the block for each turn. */
function raysOf(turns: number, [x, y]: Vec3, min: Vec3, max: Vec3): Points {
  const reach = Math.max(max[0] - min[0], max[1] - min[1]) / 2;
  const rays = Array.from({ length: turns }, (_, n): Vec3[] => {
    const angle = (2 * Math.PI * n) / turns;
    return [
      [x, y, max[2]],
      [x + reach * Math.cos(angle), y + reach * Math.sin(angle), max[2]],
    ];
  });
  return [[x, y, min[2]], [x, y, max[2]], ...rays.flat()];
}

function geometryOf(points: Points): THREE.BufferGeometry {
  return new THREE.BufferGeometry().setFromPoints(points.map((at) => new THREE.Vector3(...at)));
}

export class MirrorView {
  readonly group = new THREE.Group();
  private readonly edge_ = new THREE.LineBasicMaterial({
    ...{ color: COLOR, transparent: true, opacity: EDGE },
  });
  private readonly fill_ = new THREE.MeshBasicMaterial({
    ...{ color: COLOR, transparent: true, opacity: FILL, depthWrite: false },
    side: THREE.DoubleSide,
  });

  /** Shows the plane across an axis through `middle`, or so many turns; null: nothing. */
  show(mirror: 'x' | 'y' | 'z' | number | null, middle: Vec3, bounds: Bounds): void {
    this.clear_();
    if (mirror === null) return;
    const sides = ([0, 1, 2] as const).map((n) => bounds.max[n] - bounds.min[n]);
    const margin = MARGIN * Math.max(...sides);
    const min = bounds.min.map((value) => value - margin) as Vec3;
    const max = bounds.max.map((value) => value + margin) as Vec3;
    if (typeof mirror === 'number') {
      const points = raysOf(mirror, middle, min, max);
      this.group.add(new THREE.LineSegments(geometryOf(points), this.edge_));
      return;
    }
    const axis = ({ x: 0, y: 1, z: 2 } as const)[mirror];
    const corners = cornersOf(axis, middle, min, max);
    const plane = geometryOf(corners).setIndex([0, 1, 2, 0, 2, 3]);
    this.group.add(new THREE.Mesh(plane, this.fill_));
    this.group.add(new THREE.LineLoop(geometryOf(corners), this.edge_));
  }

  private clear_(): void {
    for (const child of [...this.group.children] as (THREE.Mesh | THREE.Line)[]) {
      child.geometry.dispose();
      child.removeFromParent();
    }
  }
}
