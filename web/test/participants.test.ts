// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { ForceHistory } from '../src/model/forces';
import { Participants } from '../src/model/participants';
import { emptyPose, PoseTrack } from '../src/model/pose_track';
import { STATUS_FELT } from '../src/wire/types';
import type { ParticipantInfo, ToolState } from '../src/wire/types';

const ada: ParticipantInfo = {
  participant: 1,
  name: 'Ada',
  color: '#112233',
  tool: 1,
  kind: 'agent',
};
const grace: ParticipantInfo = { participant: 2, name: 'Grace', color: '#445566', kind: 'viewer' };

function toolState(x: number, fields: Partial<ToolState> = {}): ToolState {
  return {
    participant: 1,
    tool_id: 1,
    tip_mm: [x, 0, 0],
    axis: [0, 0, 1],
    status: 1,
    force_n: [3, 4, 0],
    torque_nmm: [0, 0, 10],
    removed_rate_mm3_per_s: 1,
    felt_share: 0,
    ...fields,
  };
}

describe('participants', () => {
  it('of the past are those of the newest frame, also those who have left', () => {
    const people = new Participants();
    people.setList([ada]);
    people.applyTools([toolState(0, { participant: 5 })], 1000);
    expect(people.get(5)).toBeUndefined();
    people.looksBack = true;
    people.applyTools([toolState(0), toolState(1, { participant: 5 })], 2000);
    expect(people.get(5)?.info).toMatchObject({ name: 'Participant 5', kind: 'agent', tool: 1 });
    expect(people.get(5)?.track.empty).toBe(false);
    people.applyTools([toolState(2, { participant: 5 })], 3000);
    expect(people.get(1)?.track.empty).toBe(true);
    expect(people.get(5)?.track.empty).toBe(false);
    people.setList([ada]); // the present
    expect(people.get(5)).toBeUndefined();
  });

  it('of the past keep the names of those who have left', () => {
    const people = new Participants();
    people.setList([ada, grace]);
    people.change({ type: 'participants_changed', changed: [], left: [1], viewers: 0 });
    people.looksBack = true;
    people.applyTools([toolState(0), toolState(1, { participant: 5 })], 1000);
    expect(people.get(1)?.info).toMatchObject({ name: 'Ada', color: '#112233' });
    people.learn([
      { participant: 1, name: 'Ada', color: '#112233' },
      { participant: 5, name: 'Lin', color: '#778899' },
    ]);
    expect(people.get(5)?.info).toMatchObject({ name: 'Lin', color: '#778899', kind: 'agent' });
    expect(people.author(5)?.name).toBe('Lin');
  });

  it('who are present have the names of the list, not older ones from the server', () => {
    const people = new Participants();
    people.setList([{ ...ada, name: 'Countess' }]);
    people.learn([{ participant: 1, name: 'Ada', color: '#112233' }]);
    expect(people.get(1)?.info.name).toBe('Countess');
    expect(people.author(1)?.name).toBe('Countess');
  });

  it('follow the list and keep their forces when renamed', () => {
    const people = new Participants();
    people.setList([ada, grace]);
    people.applyTools([toolState(0)], 1000);
    people.setList([{ ...ada, name: 'Countess' }, grace]);
    expect(people.get(1)?.info.name).toBe('Countess');
    expect(people.get(1)?.forces.latest).toEqual({ forceN: 5, torqueNmm: 10 });
    people.setList([grace]);
    expect(people.get(1)).toBeUndefined();
  });

  it('apply changes to the list and keep the forces of those who stay', () => {
    const people = new Participants();
    people.setList([ada, grace], 1);
    people.applyTools([toolState(0)], 1000);
    const linus = { ...ada, participant: 7, name: 'Linus' };
    people.change({
      type: 'participants_changed',
      changed: [{ ...ada, tool: 2 }, linus],
      left: [2, 99],
      viewers: 812,
    });
    expect(people.all().map((p) => p.info.name)).toEqual(['Ada', 'Linus']);
    expect(people.get(1)?.info.tool).toBe(2);
    expect(people.get(1)?.forces.latest.forceN).toBe(5);
    expect(people.viewers).toBe(812);
  });

  it('count the viewers of a list without a number', () => {
    const people = new Participants();
    people.setList([ada, grace]);
    expect(people.viewers).toBe(1);
    people.setList([ada], 51);
    expect(people.viewers).toBe(51);
  });

  it('lists agents but not viewers as carvers', () => {
    const people = new Participants();
    people.setList([grace, ada]);
    expect(people.carvers().map((p) => p.info.name)).toEqual(['Ada']);
  });

  it('show who carves in the page as one person', () => {
    const people = new Participants();
    const own: ParticipantInfo = { ...grace, participant: 3, kind: 'agent', tool: 1 };
    const namesake: ParticipantInfo = { ...grace, participant: 4, color: '#abcdef' };
    people.setList([ada, grace, namesake, own]);
    expect(people.watchers().map(({ info }) => info.participant)).toEqual([4]);
    expect(people.isAgentOf(2, people.get(3)!)).toBe(true);
    expect(people.isAgentOf(4, people.get(3)!)).toBe(false);
    expect(people.isAgentOf(2, people.get(1)!)).toBe(false);
    expect(people.isAgentOf(undefined, people.get(3)!)).toBe(false);
    people.change({ type: 'participants_changed', changed: [], left: [3], viewers: 2 });
    expect(people.watchers().map(({ info }) => info.participant)).toEqual([2, 4]);
  });

  it('know the share of the wrench that a device outputs, if the agent states it', () => {
    const people = new Participants();
    people.setList([ada]);
    people.applyTools([toolState(0)], 1000);
    expect(people.get(1)?.feltShare).toBeNull();
    people.applyTools([toolState(1, { status: 1 | STATUS_FELT, felt_share: 0.17 })], 1100);
    expect(people.get(1)?.feltShare).toBe(0.17);
    people.forgetPoses();
    expect(people.get(1)?.feltShare).toBeNull();
  });

  it('ignore tool states of unknown participants and outdated states', () => {
    const people = new Participants();
    people.setList([ada]);
    people.applyTools([toolState(1), toolState(9, { participant: 77 })], 1000);
    people.applyTools([toolState(2, { tool_id: 5 })], 999);
    expect(people.get(77)).toBeUndefined();
    expect(people.get(1)?.tool).toBe(1);
    expect(people.get(1)?.forces.count).toBe(1);
  });
});

describe('pose track', () => {
  it('interpolates positions linearly and keeps the axis a unit vector', () => {
    const track = new PoseTrack();
    track.push(0, toolState(0, { axis: [0, 0, 1] }));
    track.push(100, toolState(10, { axis: [1, 0, 0] }));
    const pose = emptyPose();
    track.sample(25, pose);
    expect(pose.tip[0]).toBeCloseTo(2.5, 12);
    expect(Math.hypot(...pose.axis)).toBeCloseTo(1, 12);
    expect(pose.axis[2]).toBeGreaterThan(pose.axis[0]);
  });

  it('is constant before the first and after the last sample', () => {
    const track = new PoseTrack();
    const pose = emptyPose();
    expect(track.sample(0, pose)).toBe(false);
    track.push(100, toolState(1));
    track.push(200, toolState(2));
    track.sample(50, pose);
    expect(pose.tip[0]).toBe(1);
    track.sample(900, pose);
    expect(pose.tip[0]).toBe(2);
  });

  it('keeps the newest samples after wrapping around', () => {
    const track = new PoseTrack();
    for (let t = 0; t < 1000; ++t) track.push(t, toolState(t));
    const pose = emptyPose();
    track.sample(970.5, pose);
    expect(pose.tip[0]).toBeCloseTo(970.5, 9);
    track.sample(0, pose);
    expect(pose.tip[0]).toBeGreaterThan(900); // the oldest kept sample
  });

  it('drops samples older than the newest', () => {
    const track = new PoseTrack();
    track.push(100, toolState(1));
    track.push(90, toolState(7));
    const pose = emptyPose();
    track.sample(95, pose);
    expect(pose.tip[0]).toBe(1);
  });
});

describe('force history', () => {
  it('keeps a time window and its peak', () => {
    const history = new ForceHistory(10);
    for (let t = 0; t <= 30; ++t) history.push(t, t === 5 ? 99 : t, 2 * t);
    const [times, forces, torques] = history.series();
    expect(times[0]).toBe(20);
    expect(times.at(-1)).toBe(30);
    expect(forces.length).toBe(torques.length);
    expect(history.peak).toEqual({ forceN: 30, torqueNmm: 60 });
  });

  it('computes a typical value despite a single peak and pauses', () => {
    const history = new ForceHistory(10);
    for (let i = 0; i < 600; ++i) history.push(i / 60, i % 2 === 0 ? 0 : i === 301 ? 20 : 3, 0);
    expect(history.typical.forceN).toBeGreaterThan(2.9);
    expect(history.typical.forceN).toBeLessThan(3.5);
    expect(history.typical.torqueNmm).toBe(0);
    expect(history.peak.forceN).toBe(20);
  });

  it('stays bounded and ordered over a long time', () => {
    const history = new ForceHistory(10);
    for (let i = 0; i < 50000; ++i) history.push(i / 60, i, i);
    const [times, forces] = history.series();
    expect(times.length).toBeLessThanOrEqual(602);
    expect(forces.at(-1)).toBe(49999);
    for (let i = 1; i < times.length; ++i) expect(times[i]!).toBeGreaterThan(times[i - 1]!);
  });

  it('keeps the newest samples if the window exceeds the buffer', () => {
    const history = new ForceHistory(10);
    for (let i = 0; i < 20000; ++i) history.push(i / 1000, i, i);
    const [times] = history.series();
    expect(times.at(-1)).toBeCloseTo(19.999, 9);
    expect(times.length).toBeGreaterThan(2000);
  });
});
