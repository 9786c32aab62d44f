// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from 'three';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { SessionModel } from '../src/model/session';
import type { TogetherParts } from '../src/ui/together/host';
import type { TogetherHost } from '../src/ui/together/host';
import { SharedViews } from '../src/ui/together/shared_views';
import type { CameraMarks } from '../src/view/camera_marks';
import type { Viewer } from '../src/view/viewer';
import type { ShownCamera, Welcome } from '../src/wire/types';
import { FakeElement, stubPage } from './support/fake_dom';

const GRACE: ShownCamera = {
  participant: 7,
  name: 'Grace',
  color: '#112233',
  eye_mm: [0, 0, 50],
  target_mm: [0, 0, 0],
  parallel: true,
};
const WELCOME = {
  type: 'welcome',
  participant: 9,
  participants: [],
  tools: [],
} as unknown as Welcome;

describe('“Follow me”', () => {
  let model: SessionModel;
  let sent: unknown[];
  let said: string[];
  let rig: ReturnType<typeof fakeRig>;
  let viewer: { rig: typeof rig; parallel: boolean };
  let share: FakeElement;
  let cameras: FakeElement;
  let marked: string[];
  let views: SharedViews;

  function fakeRig() {
    const made = {
      camera: { position: new Vector3(1, 2, 3) },
      controls: { target: new Vector3() },
      parallel: false,
      tracks: false,
      /** Moves the camera at once. */
      track: (pose: { eye: Vector3 } | null) => {
        made.tracks = pose !== null;
        if (pose) made.camera.position.copy(pose.eye);
      },
    };
    return made;
  }

  beforeEach(() => {
    stubPage();
    model = new SessionModel();
    model.apply(WELCOME);
    model.setStatus('connected', '');
    [sent, said, marked] = [[], [], []];
    rig = fakeRig();
    viewer = { rig, parallel: false };
    [share, cameras] = [new FakeElement(), new FakeElement()];
    const host = {
      model,
      picture: { follow: () => undefined },
      showCamera: (pose: unknown) => sent.push(pose),
      say: (text: string) => said.push(text),
    } as unknown as TogetherHost;
    const marks = {
      show: (shown: ShownCamera[]) => (marked = shown.map(({ name }) => name)),
    } as unknown as CameraMarks;
    const parts = { share, cameras } as unknown as TogetherParts;
    views = new SharedViews(host, viewer as unknown as Viewer, marks, parts);
  });
  afterEach(() => vi.unstubAllGlobals());

  const chip = (): FakeElement => cameras.children[0]!.children[0]!;
  function grace(change: Partial<ShownCamera> = {}): void {
    model.apply({ type: 'cameras', cameras: [{ ...GRACE, ...change }] });
    views.update();
  }

  it('sends the camera when it has moved, and at another server again', () => {
    views.share();
    expect(share.getAttribute('aria-pressed')).toBe('true');
    for (let n = 0; n < 3; ++n) views.update();
    expect(sent).toEqual([{ eye_mm: [1, 2, 3], target_mm: [0, 0, 0], parallel: false }]);
    rig.camera.position.x = 4;
    views.update();
    expect(sent).toHaveLength(2);
    model.setStatus('reconnecting', '');
    rig.camera.position.x = 5;
    views.update();
    expect(sent).toHaveLength(2);
    model.apply({ ...WELCOME });
    model.setStatus('connected', '');
    rig.camera.position.x = 4;
    views.update();
    expect(sent).toHaveLength(3);
    views.share();
    views.update();
    expect([sent.at(-1), sent.length]).toEqual([null, 4]);
  });

  it('follows the camera of another one, and shows no mark of it meanwhile', () => {
    grace();
    expect([chip().textContent, marked]).toEqual(['Follow Grace', ['Grace']]);
    chip().click();
    grace({ eye_mm: [0, 40, 50] });
    expect([chip().textContent, marked]).toEqual(['Following Grace', []]);
    expect(chip().getAttribute('aria-pressed')).toBe('true');
    expect(rig.camera.position.toArray()).toEqual([0, 40, 50]);
    expect(viewer.parallel).toBe(true);
  });

  it('ends when the user moves the picture', () => {
    grace();
    chip().click();
    views.update();
    rig.tracks = false; // as the rig says after a key or a pointer
    views.update();
    expect(chip().getAttribute('aria-pressed')).toBe('false');
    expect(said.at(-1)).toBe('You are back to your own view.');
  });

  it('ends when the view is no longer shared', () => {
    grace();
    chip().click();
    model.apply({ type: 'cameras', cameras: [] });
    views.update();
    expect(cameras.children).toEqual([]);
    expect([rig.tracks, said.at(-1)]).toEqual([false, 'The view is no longer shared.']);
  });

  it("does not offer one's own view", () => {
    grace({ participant: 9 });
    expect([cameras.children, marked]).toEqual([[], []]);
  });
});
