// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { h, render } from 'preact';
import { Vector3 } from 'three';
import { beforeEach, describe, expect, it } from 'vitest';
import { SessionModel } from '../src/model/session';
import type { TogetherHost } from '../src/ui/together/host';
import { CameraRows } from '../src/ui/together/rows';
import { SharedViews } from '../src/ui/together/shared_views';
import { TogetherState } from '../src/ui/together/state';
import type { CameraMarks } from '../src/view/camera_marks';
import type { Viewer } from '../src/view/viewer';
import type { ShownCamera, Welcome } from '../src/wire/types';
import { turn } from './support/turn';

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
  let state: TogetherState;
  let list: HTMLElement;
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
    model = new SessionModel();
    model.apply(WELCOME);
    model.setStatus('connected', '');
    [sent, said, marked] = [[], [], []];
    rig = fakeRig();
    viewer = { rig, parallel: false };
    state = new TogetherState();
    const host = {
      model,
      picture: { follow: () => undefined },
      showCamera: (pose: unknown) => sent.push(pose),
      say: (text: string) => said.push(text),
    } as unknown as TogetherHost;
    const marks = {
      show: (shown: ShownCamera[]) => (marked = shown.map(({ name }) => name)),
    } as unknown as CameraMarks;
    views = new SharedViews(host, viewer as unknown as Viewer, marks, state);
    list = document.createElement('ul');
    render(h(CameraRows, { views }), list);
  });

  const chip = (): HTMLElement => list.querySelector('button')!;
  async function grace(change: Partial<ShownCamera> = {}): Promise<void> {
    model.apply({ type: 'cameras', cameras: [{ ...GRACE, ...change }] });
    views.update();
    await turn();
  }

  it('sends the camera when it has moved, and at another server again', () => {
    views.share();
    expect(state.isShared.value).toBe(true);
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

  it('follows the camera of another one, and shows no mark of it meanwhile', async () => {
    await grace();
    expect([chip().textContent, marked]).toEqual(['Follow Grace', ['Grace']]);
    chip().click();
    await grace({ eye_mm: [0, 40, 50] });
    expect([chip().textContent, marked]).toEqual(['Following Grace', []]);
    expect(chip().getAttribute('aria-pressed')).toBe('true');
    expect(rig.camera.position.toArray()).toEqual([0, 40, 50]);
    expect(viewer.parallel).toBe(true);
  });

  it('ends when the user moves the picture', async () => {
    await grace();
    chip().click();
    views.update();
    rig.tracks = false; // as the rig says after a key or a pointer
    views.update();
    await turn();
    expect(chip().getAttribute('aria-pressed')).toBe('false');
    expect(said.at(-1)).toBe('You are back to your own view.');
  });

  it('ends when the view is no longer shared', async () => {
    await grace();
    chip().click();
    model.apply({ type: 'cameras', cameras: [] });
    views.update();
    await turn();
    expect(list.children).toHaveLength(0);
    expect([rig.tracks, said.at(-1)]).toEqual([false, 'The view is no longer shared.']);
  });

  it("does not offer one's own view", async () => {
    await grace({ participant: 9 });
    expect([list.children.length, marked]).toEqual([0, []]);
  });
});
