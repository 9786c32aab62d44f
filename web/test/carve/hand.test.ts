// SPDX-License-Identifier: Apache-2.0
import * as THREE from 'three';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { DragStrength } from '../../src/carve/drag';
import { Hand } from '../../src/carve/hand';
import type { Pose } from '../../src/carve/tool/path_queue';
import type { Place } from '../../src/carve/place';
import type { Draft } from '../../src/carve/sample_log';
import { DisplayedSurface } from '../../src/view/displayed_surface';
import type { TileView } from '../../src/view/tile_view';
import type { Viewer } from '../../src/view/viewer';
import type { ToolInfo, Vec3 } from '../../src/wire/types';
import { block, SIDE, tileOf, WELCOME } from '../support/tiles';

const BALL: ToolInfo = { id: 4, shape: 'ball', diameter_mm: 3, length_mm: 20 };
const at = (
  x: number,
  y = 0,
  pressure: number | null = null,
  tilt: Place['tilt'] = null,
): Place => ({ x, y, pressure, tilt });

describe('hand', () => {
  let tiles: TileView;
  let displayed: DisplayedSurface;
  let scene: THREE.Scene;
  let shown: (Place | null)[];
  let hand: Hand;
  let nowUs: number;
  /** Where the pointer's rays come from; places are millimeters on a plane below. */
  let eye: THREE.Vector3;

  beforeEach(() => {
    tiles = block(() => -2);
    scene = new THREE.Scene();
    shown = [];
    nowUs = 1e6;
    eye = new THREE.Vector3(0, 0, 500);
    displayed = new DisplayedSurface(tiles);
    const viewer = {
      displayed,
      stage: { scene },
      touchAll: vi.fn(),
      ray: (x: number, y: number) => {
        const target = new THREE.Vector3(x, y, -2);
        return new THREE.Ray(eye, target.sub(eye).normalize());
      },
    };
    Object.assign(viewer, {
      upright: (right: number, towards: number) =>
        new THREE.Vector3(right, -towards, Math.sqrt(1 - right * right - towards * towards)),
    });
    hand = new Hand(viewer as unknown as Viewer, (place) => shown.push(place));
    hand.sampler.limits = { speedMmPerS: 5000, samplesPerS: 1250 };
    hand.takeTool(BALL, '#d9541e', WELCOME);
  });

  /** All samples until nothing waits. */
  function samples(): Draft[] {
    const all: Draft[] = [];
    for (let n = 0; n < 60; ++n) {
      nowUs += 8000;
      all.push(...hand.sampler.take(nowUs));
    }
    return all;
  }

  it('plunges, carves at its depth, and lifts', () => {
    expect(hand.begin(at(-6), 1)).toBe('');
    expect(hand.isCutting).toBe(true);
    hand.move([at(0), at(6)], 1);
    hand.end(1);
    const all = samples();
    const cutting = all.filter(({ buttons }) => buttons !== 0);
    expect(all[0]).toMatchObject({ buttons: 0, tool_id: 4 });
    expect(all[0]!.tip_mm[2]).toBeGreaterThan(-2);
    expect(all.at(-1)!.buttons).toBe(0);
    expect(all.at(-1)!.tip_mm[2]).toBeGreaterThan(-2);
    for (const { tip_mm } of cutting) expect(tip_mm[2]).toBeCloseTo(-3);
    expect(cutting[0]!.tip_mm[0]).toBeCloseTo(-6);
    expect(cutting.at(-1)!.tip_mm[0]).toBeCloseTo(6);
    expect(hand.isCutting).toBe(false);
  });

  it('lets the surface go when it rests', () => {
    hand.hover(at(0), true);
    const known = displayed.pieces;
    expect(displayed.pieces).toBe(known);
    hand.rest();
    expect(shown.at(-1)).toBeNull();
    const asked = vi.spyOn(displayed, 'pieces', 'get');
    hand.hover(at(0), true);
    expect(asked).toHaveBeenCalledOnce();
    expect(displayed.pieces).not.toBe(known);
  });

  it('does not dig when it goes over its own cut again', () => {
    hand.begin(at(-2), 1);
    hand.move([at(0), at(2)], 1);
    samples();
    tiles.set(
      tileOf(2, 2, () => -3),
      2,
      2,
      SIDE,
    ); // the server's mesh has come
    hand.move([at(0), at(-2)], 1);
    hand.end(1);
    const cutting = samples().filter(({ buttons }) => buttons !== 0);
    expect(cutting.length).toBeGreaterThan(2);
    for (const { tip_mm } of cutting) expect(tip_mm[2]).toBeCloseTo(-3);
    // The next stroke begins at the new surface.
    hand.begin(at(0), 1);
    expect(samples().at(-1)!.tip_mm[2]).toBeCloseTo(-4);
  });

  it('holds the plane to the end of one stroke', () => {
    hand.holdPlane();
    hand.begin(at(0), 1);
    expect(hand.settings.mode).toBe('plane');
    hand.end(1);
    expect(hand.settings.mode).toBe('surface');
    hand.holdPlane();
    hand.holdPlane(); // the finger still rests
    hand.end(1); // one that found nothing to cut
    expect(hand.settings.mode).toBe('surface');
    hand.settings.mode = 'plane';
    hand.end(1);
    expect(hand.settings.mode).toBe('plane'); // the user's choices since then
  });

  it('goes on with a stroke while another pointer moves away', () => {
    hand.begin(at(-6), 1);
    hand.hover(null, true);
    hand.moveTo({ tip: [9, 9, 9], axis: [0, 0, 1] }, true, true);
    expect(hand.pose!.tip[0]).toBeCloseTo(-6);
    hand.move([at(6)], 1);
    hand.end(1);
    for (const { tip_mm } of samples()) expect(tip_mm[2]).toBeLessThan(0);
  });

  it('is shown again where it is when its settings change', () => {
    hand.settings.depthMm = 1;
    hand.hover(at(2), false);
    const { tip } = hand.pose!;
    hand.settings.depthMm = 1.5;
    hand.hoverAgain(false);
    expect(hand.pose!.tip[0]).toBeCloseTo(tip[0]);
    expect(hand.pose!.tip[2]).toBeCloseTo(tip[2] - 0.5);
    hand.hide();
    hand.hoverAgain(false);
    expect(hand.pose).toBeNull();
  });

  it('cuts with a device that is no pointer from where the tool was, and lifts it there', () => {
    const pose = (x: number): Pose => ({ tip: [x, 0, -1], axis: [0, 0, 1] });
    hand.moveTo(pose(0), false, true);
    hand.moveTo(pose(1), true, true);
    hand.moveTo(pose(2), true, true);
    expect(hand.isCutting).toBe(true);
    hand.lift();
    const drafts = [1, 2, 3, 4, 5, 6].flatMap((n) => hand.sampler.take(n * 1e5));
    const cuts = drafts.map(({ tip_mm: [x], buttons }) => [x, buttons !== 0]);
    expect(cuts[0]).toEqual([0, false]);
    expect(cuts.filter(([, is]) => !is)).toHaveLength(2);
    expect(cuts.filter(([, is]) => is).at(-1)).toEqual([2, true]);
    expect(cuts.at(-1)).toEqual([2, false]);
    expect(hand.isCutting).toBe(false);
  });

  it('begins each stroke of such a device where the tool is then, and ends it when it rests', () => {
    const pose = (x: number): Pose => ({ tip: [x, 0, -1], axis: [0, 0, 1] });
    hand.moveTo(pose(0), false, true);
    expect(samples()).toHaveLength(1);
    hand.lift();
    expect(samples()).toEqual([]); // it did not cut
    hand.moveTo(pose(2), true, true);
    hand.lift();
    samples();
    hand.moveTo(pose(2.5), true, true);
    expect(samples()[0]).toMatchObject({ tip_mm: [2.5, 0, -1], buttons: 0 });
    hand.rest();
    expect([hand.isCutting, hand.pose]).toEqual([false, null]);
    expect(samples().at(-1)).toMatchObject({ tip_mm: [2.5, 0, -1], buttons: 0 });
  });

  it('is drawn and sends nothing before other viewers may see it', () => {
    hand.moveTo({ tip: [1, 0, -1], axis: [0, 0, 1] }, true, false);
    expect(hand.pose!.tip).toEqual([1, 0, -1]);
    expect([hand.isCutting, samples()]).toEqual([false, []]);
  });

  it('cuts less deep under less pressure', () => {
    hand.begin(at(-6, 0, 0.5), 1);
    hand.move([at(6, 0, 0.5)], 1);
    hand.end(1);
    const cutting = samples().filter(({ buttons }) => buttons !== 0);
    for (const { tip_mm } of cutting) expect(tip_mm[2]).toBeCloseTo(-2.5);
  });

  it('leans as the pen does, if that is chosen', () => {
    const pen = (x: number): Place => at(x, 0, 1, [0.3, 0.4]);
    for (const axis of ['vertical', 'surface', 'pen'] as const) {
      hand.settings.axis = axis;
      hand.begin(pen(-6), 1);
      hand.move([pen(6)], 1);
      hand.end(1);
      const cutting = samples().filter(({ buttons }) => buttons !== 0);
      expect(cutting.length).toBeGreaterThan(1);
      const expected = axis === 'pen' ? [0.3, -0.4, Math.sqrt(0.75)] : [0, 0, 1];
      for (const sample of cutting)
        for (let i = 0; i < 3; ++i) expect(sample.axis[i]).toBeCloseTo(expected[i]!);
    }
  });

  it('is lifted over a gap of the surface', () => {
    const height = (x: number): number => (x < 2 ? -2 : -11);
    for (let n = 0; n < 5; n += 1)
      for (let m = 0; m < 5; m += 1) tiles.set(tileOf(n, m, height), n, m, SIDE);
    // Between 1 and 2 the tiles have a slope of 84°, seen from above; from aside it hides the floor.
    eye.x = -600;
    hand.begin(at(-6), 1);
    hand.move([at(0), at(14)], 1);
    hand.end(1);
    const all = samples();
    const clear = all.filter(({ buttons }) => buttons === 0);
    expect(clear.length).toBe(3); // there, over the gap, and away
    const cutting = all.filter(({ buttons }) => buttons !== 0);
    expect(cutting[0]!.tip_mm[2]).toBeCloseTo(-3);
    expect(cutting.at(-1)!.tip_mm[2]).toBeCloseTo(-12);
    cutting.slice(1).forEach((sample, n) => {
      const before = cutting[n]!;
      const falls = before.tip_mm[2] - sample.tip_mm[2];
      const isNext = all.indexOf(sample) === all.indexOf(before) + 1;
      if (isNext) expect(falls).toBeLessThan(6);
    });
  });

  it('knows when it carves a side', () => {
    hand.begin(at(0), 1);
    expect(hand.isOnSide).toBe(false);
    hand.end(1);
    hand.moveTo({ tip: [1, 0, -1], axis: [0.8, 0, 0.6] }, false, true);
    expect(hand.isOnSide).toBe(false);
    hand.moveTo({ tip: [2, 0, -1], axis: [0.8, 0, 0.6] }, true, true);
    expect(hand.isOnSide).toBe(true);
  });

  it('is drawn at the pointer, and cuts up to there when the pointer rests', () => {
    hand.begin(at(0), 1);
    hand.move([at(8)], 1);
    expect(shown.at(-1)).toEqual(at(8));
    expect(scene.children[0]!.position.x).toBeCloseTo(8);
    expect(samples().at(-1)!.tip_mm[0]).toBeCloseTo(4);
    hand.settle(1, performance.now());
    expect(samples().at(-1)!.tip_mm[0]).toBeCloseTo(4);
    hand.settle(1, performance.now() + 100);
    expect(samples().at(-1)!.tip_mm[0]).toBeCloseTo(8);
  });

  it('does not cut up to a pointer that has just moved, however long the stroke lasts', () => {
    const now = vi.spyOn(performance, 'now').mockReturnValue(1000);
    hand.begin(at(0), 1);
    now.mockReturnValue(5000);
    hand.move([at(8)], 1);
    hand.settle(1, 5030);
    expect(samples().at(-1)!.tip_mm[0]).toBeCloseTo(4);
    now.mockRestore();
  });

  it('cuts the same path when the force holds it back, only later', () => {
    const path = (strength: DragStrength): Vec3[] => {
      hand.drag.strength = strength;
      const startMs = performance.now();
      hand.begin(at(-6), 1);
      hand.pull(1, startMs + 500); // the force is there
      hand.move([at(0), at(6)], 1);
      hand.settle(1, startMs + 1000);
      const atOnce = scene.children[0]!.position.x;
      if (strength === 'off') expect(atOnce).toBeCloseTo(6);
      else expect(atOnce).toBeCloseTo(-6);
      let last = atOnce;
      for (let ms = 508; ms < 5000; ms += 8) {
        hand.pull(1, startMs + ms);
        const { x } = scene.children[0]!.position;
        expect(x).toBeGreaterThanOrEqual(last - 1e-6);
        expect(x).toBeLessThanOrEqual(6 + 1e-6);
        if (strength === 'strong' && ms === 508) expect(x).toBeLessThan(0);
        last = x;
      }
      expect(last).toBeCloseTo(6);
      hand.end(1);
      return samples()
        .filter(({ buttons }) => buttons !== 0)
        .map(({ tip_mm }) => tip_mm);
    };
    const ends = (['off', 'light', 'strong'] as const).map((strength) => path(strength));
    for (const tips of ends) {
      expect(tips[0]![0]).toBeCloseTo(-6);
      expect(tips.at(-1)![0]).toBeCloseTo(6);
      for (const [, y, z] of tips) expect([y, z]).toEqual([expect.closeTo(0), expect.closeTo(-3)]);
    }
  });

  it('is at the pointer when the stroke ends, however slow it was', () => {
    hand.drag.strength = 'strong';
    hand.begin(at(-6), 1);
    hand.pull(1, performance.now() + 500);
    hand.move([at(0), at(6)], 1);
    hand.end(1);
    const cutting = samples().filter(({ buttons }) => buttons !== 0);
    expect(cutting.at(-1)!.tip_mm[0]).toBeCloseTo(6);
  });

  it('shows other viewers where it waits, clear of the block', () => {
    hand.hover(at(3), true);
    expect(samples()).toMatchObject([{ buttons: 0 }]);
    hand.hover(at(5), false);
    expect(samples()).toEqual([]);
    expect(scene.children[0]!.visible).toBe(true);
    hand.hover(at(90), true);
    expect(scene.children[0]!.visible).toBe(false);
    expect(shown.at(-1)).toBeNull();
  });

  it('says why it does not begin', () => {
    // An overhang, seen from below: its normal points down.
    const overhang = tileOf(2, 2, () => -2);
    overhang.geometry!.setIndex([...overhang.geometry!.index!.array].reverse());
    tiles.set(overhang, 2, 2, SIDE);
    eye.z = -500;
    hand.settings.axis = 'vertical';
    expect(hand.begin(at(0), 1)).toContain('reach this spot');
    expect(hand.begin(at(90), 1)).toBe('');
    expect(hand.isCutting).toBe(false);
    expect(samples()).toEqual([]);
  });
});
