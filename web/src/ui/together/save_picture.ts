// SPDX-License-Identifier: Apache-2.0
// The picture as a file: larger than the screen, with the page's background, without the elements
// over it.

import { t } from '../../strings';
import type { Viewer } from '../../view/viewer';
import { saveFile } from '../save_file';

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

/**
 * Draws the picture over the page's background.
 * @param pixels on the longer side, as far as the graphics device allows
 * @param to its size is that of the picture, less a pixel where that is odd and `isEven`
 */
export function drawPicture(
  viewer: Viewer,
  pixels: number,
  to: HTMLCanvasElement,
  isEven = false,
): void {
  const drawn = viewer.drawLarge(pixels, !viewer.isRecording);
  const step = isEven ? 2 : 1;
  const [width, height] = [drawn.width, drawn.height].map((side) => side - (side % step)) as [
    number,
    number,
  ];
  if (to.width !== width || to.height !== height) Object.assign(to, { width, height });
  const context = to.getContext('2d');
  if (!context) throw new Error(t("This browser can't make a picture this large."));
  context.fillStyle = skyOf(context, width, height);
  context.fillRect(0, 0, width, height);
  context.drawImage(drawn, 0, 0);
}

export async function pictureOf(viewer: Viewer, pixels = PICTURE_PIXELS): Promise<Blob> {
  const canvas = document.createElement('canvas');
  drawPicture(viewer, pixels, canvas);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
  if (!blob) throw new Error(t('The browser could not save the picture.'));
  return blob;
}

/** Saves a file with the name of the session. */
export function saveAs(content: Blob, session: string, extension: string): void {
  saveFile(`${session.replaceAll(/[^\p{L}\p{N}_-]+/gu, '-')}${extension}`, content);
}

export async function savePicture(viewer: Viewer, name: string): Promise<void> {
  saveAs(await pictureOf(viewer), name, '.png');
}
