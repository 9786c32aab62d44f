// SPDX-License-Identifier: Apache-2.0
// A video of the block that turns once, frame by frame, however long a frame takes to draw. It is
// encoded by WebCodecs, so nothing leaves the browser.

import { ArrayBufferTarget, Muxer } from 'mp4-muxer';
import { t } from '../../strings';
import type { Viewer } from '../../view/viewer';
import { drawPicture } from './save_picture';

const SECONDS = 6;

interface Quality {
  /** On the longer side. */
  pixels: number;
  framesPerSecond: number;
}
const FULL: Quality = { pixels: 1920, framesPerSecond: 30 };
/** Where the CPU draws. */
const SOFTWARE: Quality = { pixels: 640, framesPerSecond: 12 };
/** Frames that wait for the encoder. */
const QUEUED_MAX = 4;

/** The codecs that most players know first; names as in RFC 6381. */
const CODECS = [
  ['avc', 'avc1.640028'],
  ['vp9', 'vp09.00.40.08'],
  ['av1', 'av01.0.08M.08'],
] as const;

type Codec = (typeof CODECS)[number][0];

async function codecFor(
  width: number,
  height: number,
  framerate: number,
): Promise<{ codec: Codec; config: VideoEncoderConfig }> {
  if (typeof VideoEncoder === 'undefined')
    throw new Error(t("This browser can't save videos. Try a current version of Chrome or Edge."));
  for (const [codec, name] of CODECS) {
    const config: VideoEncoderConfig = {
      codec: name,
      width,
      height,
      bitrate: 4 * width * height,
      framerate,
    };
    const { supported } = await VideoEncoder.isConfigSupported(config).catch(() => ({
      supported: false,
    }));
    if (supported) return { codec, config };
  }
  throw new Error(t("This browser can't save videos. Try a current version of Chrome or Edge."));
}

/**
 * Turns the camera once around the block and returns an MP4 file.
 * @param progress gets the share that is done, 0 to 1
 * @throws the signal's reason when it is aborted; the camera then stays where it is
 */
export async function turntableOf(
  viewer: Viewer,
  progress: (share: number) => void,
  signal: AbortSignal,
): Promise<Blob> {
  const { pixels, framesPerSecond } = viewer.stage.drawsInSoftware ? SOFTWARE : FULL;
  const frames = SECONDS * framesPerSecond;
  const canvas = document.createElement('canvas');
  drawPicture(viewer, pixels, canvas, true);
  const { width, height } = canvas;
  const { codec, config } = await codecFor(width, height, framesPerSecond);
  const target = new ArrayBufferTarget();
  const muxer = new Muxer({ target, video: { codec, width, height }, fastStart: 'in-memory' });
  let problem: unknown = null;
  const encoder = new VideoEncoder({
    output: (chunk, metadata) => muxer.addVideoChunk(chunk, metadata),
    error: (error) => (problem ??= error),
  });
  encoder.configure(config);
  viewer.isRecording = true;
  try {
    for (let n = 0; n < frames; n += 1) {
      signal.throwIfAborted();
      if (problem) throw problem as Error;
      drawPicture(viewer, pixels, canvas, true);
      const frame = new VideoFrame(canvas, {
        timestamp: Math.round((n * 1e6) / framesPerSecond),
        duration: Math.round(1e6 / framesPerSecond),
      });
      encoder.encode(frame, { keyFrame: n % framesPerSecond === 0 });
      frame.close();
      viewer.rig.orbit((2 * Math.PI) / frames, 0);
      viewer.rig.update(performance.now(), 0);
      progress((n + 1) / frames);
      // The page goes on meanwhile.
      do await new Promise((done) => setTimeout(done));
      while (encoder.encodeQueueSize > QUEUED_MAX);
    }
    await encoder.flush();
    if (problem) throw problem as Error;
  } finally {
    viewer.isRecording = false;
    viewer.touchAll();
    if (encoder.state !== 'closed') encoder.close();
  }
  muxer.finalize();
  return new Blob([target.buffer], { type: 'video/mp4' });
}
