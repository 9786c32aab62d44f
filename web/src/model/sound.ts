// SPDX-License-Identifier: Apache-2.0
// The sound of the nearest tool: a tone at the frequency at which its teeth pass, and the noise of
// chips, which follow force and removal rate. Pure functions; view/sound_output.ts plays them.

import type { Vec3, Welcome } from '../wire/types';
import type { Participant } from './participants';
import { emptyPose } from './pose_track';

/** Frequencies in Hz; gains from 0 to 1. */
export interface SoundLevels {
  toneHz: number;
  toneGain: number;
  noiseHz: number;
  noiseGain: number;
}

/** State of a spindle and of its tool's cut. */
export interface Cut {
  spindleRpm: number;
  teeth: number;
  forceN: number;
  removedMm3PerS: number;
}

/** A spindle of a scene whose force law states none. */
const USUAL = { spindleRpm: 12000, teeth: 2 };
const AUDIBLE_HZ = [60, 4000] as const;
const NOISE_HZ = [500, 8000] as const;
/** Noise of chips is centered on this multiple of the tone. */
const NOISE_OVER_TONE = 4;
/** Gains of a spindle that runs free, and most of a cut. */
const FREE_GAIN = 0.02;
const TONE_GAIN = 0.12;
const NOISE_GAIN = 0.25;
/** Force and removal rate at which a cut has half of its loudness. */
const HALF_N = 10;
const HALF_MM3_PER_S = 100;
/** A tool without a new state for so long is silent. */
const STALE_MS = 3000;

function clamp(value: number, [least, most]: readonly [number, number]): number {
  return Math.min(most, Math.max(least, value));
}

/**
 * Returns the sound of a cut; silence without one. Force without removal is contact, and removal
 * without force an imprint: both leave the tone of a spindle that runs free.
 */
export function soundOf(cut: Cut | null): SoundLevels {
  const { spindleRpm, teeth } = cut ?? USUAL;
  const toneHz = clamp((spindleRpm / 60) * teeth, AUDIBLE_HZ);
  const noiseHz = clamp(NOISE_OVER_TONE * toneHz, NOISE_HZ);
  if (!cut) return { toneHz, toneGain: 0, noiseHz, noiseGain: 0 };
  const force = cut.forceN / (cut.forceN + HALF_N);
  const removal = cut.removedMm3PerS / (cut.removedMm3PerS + HALF_MM3_PER_S);
  const level = Math.sqrt(force * removal);
  return {
    toneHz,
    toneGain: FREE_GAIN + (TONE_GAIN - FREE_GAIN) * level,
    noiseHz,
    noiseGain: NOISE_GAIN * level,
  };
}

/** Returns the cut of the tool that is nearest to a point, or null if no tool has moved lately. */
export function nearestCut(
  carvers: readonly Participant[],
  point: Vec3,
  force: Welcome['force'],
  nowMs: number,
): Cut | null {
  const pose = emptyPose();
  let nearest: Cut | null = null;
  let least = Infinity;
  for (const { track, seenMs } of carvers) {
    if (nowMs - seenMs > STALE_MS || !track.sample(nowMs, pose)) continue;
    const distance = Math.hypot(...pose.tip.map((x, i) => x - point[i]!));
    if (distance >= least) continue;
    least = distance;
    nearest = {
      spindleRpm: force?.spindle_rpm ?? USUAL.spindleRpm,
      teeth: force?.teeth ?? USUAL.teeth,
      forceN: Math.hypot(...pose.force),
      removedMm3PerS: Math.max(0, pose.removedRate),
    };
  }
  return nearest;
}
