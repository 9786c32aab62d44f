// SPDX-License-Identifier: Apache-2.0
// Plays SoundLevels by WebAudio: an oscillator, and noise through a band-pass. Loaded when sound is
// first turned on.

import type { SoundLevels } from '../model/sound';

const SMOOTHING_S = 0.05; // no clicks between two updates of the page
const NOISE_S = 2;
const NOISE_Q = 0.8;

/** Returns a loop of white noise. Its own generator: it needs no randomness, only many values. */
function noise(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, NOISE_S * context.sampleRate, context.sampleRate);
  const data = buffer.getChannelData(0);
  let state = 1;
  for (let i = 0; i < data.length; ++i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    data[i] = state / 2 ** 31 - 1;
  }
  return buffer;
}

export class SoundOutput {
  private readonly tone_: OscillatorNode;
  private readonly toneGain_: GainNode;
  private readonly band_: BiquadFilterNode;
  private readonly noiseGain_: GainNode;
  private loudest_ = 0;

  constructor(private readonly context: AudioContext) {
    this.tone_ = context.createOscillator();
    this.tone_.type = 'sawtooth';
    this.toneGain_ = context.createGain();
    this.toneGain_.gain.value = 0;
    this.tone_.connect(this.toneGain_).connect(context.destination);
    const source = context.createBufferSource();
    source.buffer = noise(context);
    source.loop = true;
    this.band_ = context.createBiquadFilter();
    this.band_.type = 'bandpass';
    this.band_.Q.value = NOISE_Q;
    this.noiseGain_ = context.createGain();
    this.noiseGain_.gain.value = 0;
    source.connect(this.band_).connect(this.noiseGain_).connect(context.destination);
    this.tone_.start();
    source.start();
  }

  set(levels: SoundLevels): void {
    this.loudest_ = Math.max(this.loudest_, this.noiseGain_.gain.value);
    const at = this.context.currentTime;
    this.tone_.frequency.setTargetAtTime(levels.toneHz, at, SMOOTHING_S);
    this.toneGain_.gain.setTargetAtTime(levels.toneGain, at, SMOOTHING_S);
    this.band_.frequency.setTargetAtTime(levels.noiseHz, at, SMOOTHING_S);
    this.noiseGain_.gain.setTargetAtTime(levels.noiseGain, at, SMOOTHING_S);
  }

  /** Gains at present, and the greatest of the noise so far; for tests. */
  get gains(): { tone: number; noise: number; loudest: number } {
    const noise = this.noiseGain_.gain.value;
    return { tone: this.toneGain_.gain.value, noise, loudest: Math.max(noise, this.loudest_) };
  }
}
