// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { firstLook, viewBounds } from '../src/model/first_look';
import type { PlacedLook } from '../src/model/first_look';
import type { Viewport } from '../src/model/fit';
import { errorRad } from '../src/model/look_policy';
import { STOCK_MATERIALS } from '../src/model/materials';
import { SessionModel } from '../src/model/session';
import { Picture } from '../src/ui/picture';
import type { LoadViewer } from '../src/ui/picture';
import type { MeshFrame } from '../src/decode/mesh_glb';
import { MESH_SNAPSHOT_LAST } from '../src/wire/types';
import type { Header, Vec3, Welcome } from '../src/wire/types';
import { turn } from './support/turn';

const welcome: Welcome = {
  type: 'welcome',
  session: 'demo',
  participant: 9,
  epoch: 1,
  color: '#888888',
  pitch_mm: 0.5,
  pivot_mm: 60,
  stock: { shape: 'box', min_mm: [0, 0, -20], max_mm: [100, 60, 0] },
  tools: [{ id: 4, shape: 'ball', diameter_mm: 6, length_mm: 30 }],
  participants: [],
  grid: { origin_mm: [0, 0, 0], columns: [2, 2], tile: 32 },
};
const PHONE: Viewport = {
  width: 390,
  height: 844,
  insets: { left: 0, right: 0, top: 60, bottom: 136 },
};
const last: Header = { type: 3, flags: MESH_SNAPSHOT_LAST, epoch: 1, sequence: 1n, time_us: 0n };

/** Records the page's calls of a view. */
class FakeViewer {
  static made: FakeViewer[] = [];
  readonly calls: string[] = [];
  picture: Promise<void> = Promise.resolve();
  constructor() {
    FakeViewer.made.push(this);
  }
  set arrowsVisible(visible: boolean) {
    this.calls.push(`arrows ${visible}`);
  }
  isFast = false;
  readonly stage = { drawsInSoftware: true };
  readonly eye: Vec3 = [10, 20, 30];
  look(error_rad: number): PlacedLook {
    return { look: { eye_mm: this.eye, error_rad }, distanceMm: 50 };
  }
  tick(): void {
    this.calls.push('tick');
  }
  shown(): Promise<void> {
    return this.picture;
  }
  resize({ width }: Viewport): void {
    this.calls.push(`resize ${width}`);
  }
  setMaterial({ name }: { name: string }): void {
    this.calls.push(name);
  }
  follow(id: number | null): void {
    this.calls.push(`follow ${id}`);
  }
  welcome(): void {
    this.calls.push('welcome');
  }
  applyMesh({ sequence }: Header, { motions }: MeshFrame): void {
    this.calls.push(`mesh ${sequence} of ${motions}`);
  }
}

function makePicture(model: SessionModel, make: () => FakeViewer = () => new FakeViewer()) {
  // Called with new: its result is the view.
  const Viewer = function () {
    return make();
  };
  const load = vi.fn(() => Promise.resolve({ Viewer })) as unknown as LoadViewer;
  const decode = vi.fn(() => Promise.resolve({ motions: 5, nodes: [], shapes: [] }));
  const [canvas, overlay] = [{} as HTMLCanvasElement, {} as HTMLElement];
  const picture = new Picture(canvas, overlay, model, false, load, decode);
  picture.resize(PHONE);
  return { picture, load, decode };
}

beforeEach(() => {
  FakeViewer.made = [];
  vi.stubGlobal('window', { devicePixelRatio: 3 });
});
afterEach(() => vi.unstubAllGlobals());

describe('picture', () => {
  it('does not load the view before the session was joined', () => {
    const { picture, load } = makePicture(new SessionModel());
    expect(load).not.toHaveBeenCalled();
    expect(picture.look()).toBeNull();
  });

  it('knows where it will look from as soon as the session was joined', () => {
    const model = new SessionModel();
    const { picture } = makePicture(model);
    model.apply(welcome);
    picture.welcome(welcome);
    expect(picture.viewer).toBeNull();
    expect(picture.look()).toEqual(firstLook(welcome, PHONE, errorRad(844, 3)));
  });

  it('opens the view with the earlier settings, then applies the waiting frames', async () => {
    const model = new SessionModel();
    const { picture } = makePicture(model);
    picture.setMaterial(STOCK_MATERIALS[2]!);
    picture.follow(7);
    picture.arrowsVisible = false;
    model.apply(welcome);
    picture.welcome(welcome);
    await picture.applyMesh(last, new Uint8Array());
    expect(FakeViewer.made).toHaveLength(1);
    expect([...FakeViewer.made[0]!.calls].sort()).toEqual(
      ['Tooling board', 'arrows false', 'follow 7', 'mesh 1 of 5', 'resize 390', 'welcome'].sort(),
    );
    expect(FakeViewer.made[0]!.calls.at(-1)).toBe('mesh 1 of 5');
  });

  it('drops frames of a connection that was lost before the view was open', async () => {
    const model = new SessionModel();
    const { picture } = makePicture(model);
    model.apply(welcome);
    picture.welcome(welcome);
    const applied = picture.applyMesh(last, new Uint8Array());
    model.apply(welcome); // joined again
    await applied;
    expect(FakeViewer.made[0]!.calls).not.toContain('mesh 1 of 5');
  });

  it('goes on without a picture where WebGL is missing, and asks for the least', async () => {
    vi.spyOn(console, 'warn').mockImplementation(() => undefined);
    const model = new SessionModel();
    const { picture, decode } = makePicture(model, () => {
      throw new Error('no WebGL');
    });
    model.apply(welcome);
    picture.welcome(welcome);
    await picture.applyMesh(last, new Uint8Array());
    expect(picture.problem).toBe('no WebGL');
    expect(model.tiles.complete).toBe(true);
    expect(picture.look()!.look.error_rad).toBe(1);
    expect(decode).toHaveBeenCalledTimes(1); // the frame that came before this was known
    await picture.applyMesh(last, new Uint8Array());
    expect(decode).toHaveBeenCalledTimes(1);
  });

  it('needs more tiles when a picture is shown, or at once while the block is not complete', async () => {
    const model = new SessionModel();
    const { picture } = makePicture(model);
    model.apply(welcome);
    picture.welcome(welcome);
    await picture.applyMesh({ ...last, flags: 0 }, new Uint8Array());
    let show = (): void => undefined;
    FakeViewer.made[0]!.picture = new Promise((resolve) => (show = resolve));
    await picture.needsTiles();
    model.tiles.finishSnapshot();
    await picture.applyMesh({ ...last, sequence: 2n }, new Uint8Array()); // waits for no picture
    expect(FakeViewer.made[0]!.calls).toContain('mesh 2 of 5');
    const ready = vi.fn();
    void picture.needsTiles().then(ready);
    await turn();
    expect(ready).not.toHaveBeenCalled();
    show();
    await vi.waitFor(() => expect(ready).toHaveBeenCalled());
  });

  /** A picture of a block of one carved tile, which the server sent at a coarse level. */
  async function coarsePicture(triangles: number) {
    const model = new SessionModel();
    const { picture } = makePicture(model);
    model.apply(welcome);
    picture.welcome(welcome);
    await picture.applyMesh(last, new Uint8Array());
    model.tiles.offer(0, 0, 1, triangles, 2);
    model.tiles.finishSnapshot();
    const error = (): number => picture.look()!.look.error_rad;
    return { model, picture, error };
  }

  it('asks for exact tiles at rest, and for those of its distance once it moves', async () => {
    const { picture, error } = await coarsePicture(40);
    picture.tick(0);
    expect(error()).toBe(errorRad(844, 3));
    picture.tick(2100);
    expect(error()).toBe(0);
    FakeViewer.made[0]!.eye[0] = 60;
    picture.tick(2200);
    expect(error()).toBe(errorRad(844, 3));
  });

  it('asks for finer tiles at rest where exact ones are too many', async () => {
    const { picture, error } = await coarsePicture(5e6);
    picture.tick(0);
    picture.tick(2100);
    expect(error()).toBe(errorRad(844, 3) / 4);
  });

  it('waits for exact tiles before it calls back', async () => {
    const { model, picture, error } = await coarsePicture(40);
    model.setStatus('connected', '');
    const use = vi.fn(() => Promise.resolve(error()));
    const used = picture.withExactTiles(use);
    expect(error()).toBe(0);
    await turn();
    expect(use).not.toHaveBeenCalled();
    expect(picture.isExact).toBe(false);
    model.tiles.offer(0, 0, 2, 1900, 0);
    expect(picture.isExact).toBe(true);
    expect(await used).toBe(0);
    expect(error()).toBe(errorRad(844, 3));
    expect(picture.isExact).toBe(false); // from now on coarse ones may come
  });

  it('waits no longer for exact tiles when the connection is lost, or after a minute', async () => {
    const { model, picture } = await coarsePicture(40);
    const use = vi.fn(() => Promise.resolve());
    model.setStatus('connected', '');
    const lost = picture.withExactTiles(use);
    model.setStatus('connecting', 'lost');
    await expect(lost).rejects.toThrow('full detail');
    vi.useFakeTimers();
    model.setStatus('connected', '');
    const late = expect(picture.withExactTiles(use)).rejects.toThrow('full detail');
    await vi.advanceTimersByTimeAsync(60_000);
    await late;
    vi.useRealTimers();
    model.tiles.offer(0, 0, 2, 1900, 0);
    expect(use).not.toHaveBeenCalled();
  });

  it('rejects requests for exact tiles without a connection', async () => {
    const { model, picture, error } = await coarsePicture(40);
    model.setStatus('stopped', 'gone');
    const use = vi.fn(() => Promise.resolve());
    await expect(picture.withExactTiles(use)).rejects.toThrow('full detail');
    expect(use).not.toHaveBeenCalled();
    expect(error()).toBe(errorRad(844, 3));
  });

  it('decodes a frame while the view opens', () => {
    const model = new SessionModel();
    const { picture, decode } = makePicture(model);
    model.apply(welcome);
    picture.welcome(welcome);
    void picture.applyMesh(last, new Uint8Array());
    expect(picture.viewer).toBeNull();
    expect(decode).toHaveBeenCalledTimes(1);
  });
});

describe('first look', () => {
  const tablet: Viewport = {
    width: 768,
    height: 1024,
    insets: { left: 68, right: 348, top: 60, bottom: 24 },
  };
  const low: Viewport = { ...tablet, height: 300 };

  it.each([PHONE, tablet, low])('fills the part of the picture without panels: %j', (view) => {
    const { look } = firstLook(welcome, view, 0);
    const { min, max } = viewBounds(welcome);
    expect(max[2]).toBeGreaterThan(0); // there is space for the tool
    const center = min.map((value, n) => (value + max[n]!) / 2) as Vec3;
    const arm = look.eye_mm.map((eye, n) => eye - center[n]!) as Vec3;
    const distance = Math.hypot(...arm);
    const u = arm.map((a) => a / distance) as Vec3;
    const flat = Math.hypot(u[0], u[1]);
    const side: Vec3 = [-u[1] / flat, u[0] / flat, 0];
    const up: Vec3 = [-u[2] * side[1], u[2] * side[0], u[0] * side[1] - u[1] * side[0]];
    const pixels = view.height / 2 / Math.tan(Math.PI / 12); // half of 30°
    let fills = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const p = min.map((value, n) => ((corner >> n) & 1 ? max[n]! : value) - center[n]!);
      const along = (axis: Vec3): number => p[0]! * axis[0] + p[1]! * axis[1] + p[2]! * axis[2];
      const depth = distance - along(u);
      const { left, right, top, bottom } = view.insets;
      const across = (2 * pixels * Math.abs(along(side))) / depth / (view.width - left - right);
      const above = (2 * pixels * Math.abs(along(up))) / depth / (view.height - top - bottom);
      fills = Math.max(fills, across, above);
    }
    expect(fills).toBeLessThan(1);
    expect(fills).toBeGreaterThan(0.9);
  });
});
