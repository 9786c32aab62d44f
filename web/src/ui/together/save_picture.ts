// SPDX-License-Identifier: Apache-2.0
// The picture as a file: larger than the screen, with the page's background, without what lies over
// it.

import { t } from '../../strings';
import type { Viewer } from '../../view/viewer';

/** On the longer side: a screen of 4k. */
export const PICTURE_PIXELS = 3840;

/** The light of the page's background (style/base.css), in the middle, between, and at the rim. */
function skyOf(context: CanvasRenderingContext2D, width: number, height: number): CanvasGradient {
  const style = getComputedStyle(document.documentElement);
  const [x, y] = [0.38 * width, 0.28 * height];
  const sky = context.createRadialGradient(x, y, 0, x, y, Math.max(1.2 * width, 0.9 * height));
  sky.addColorStop(0, style.getPropertyValue('--sky-middle').trim());
  sky.addColorStop(0.48, style.getPropertyValue('--sky-half').trim());
  sky.addColorStop(1, style.getPropertyValue('--sky-rim').trim());
  return sky;
}

/** @param pixels on the longer side, as far as the graphics device allows */
export async function pictureOf(viewer: Viewer, pixels = PICTURE_PIXELS): Promise<Blob> {
  const drawn = viewer.drawLarge(pixels);
  const { width, height } = drawn;
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  const context = canvas.getContext('2d');
  if (!context) throw new Error(t('The browser gives no canvas of this size.'));
  context.fillStyle = skyOf(context, width, height);
  context.fillRect(0, 0, width, height);
  context.drawImage(drawn, 0, 0);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
  if (!blob) throw new Error(t('The browser could not write the picture.'));
  return blob;
}

export async function savePicture(viewer: Viewer, name: string): Promise<void> {
  const url = URL.createObjectURL(await pictureOf(viewer));
  const link = document.createElement('a');
  Object.assign(link, { href: url, download: `${name.replaceAll(/[^\p{L}\p{N}_-]+/gu, '-')}.png` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
