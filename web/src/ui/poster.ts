// SPDX-License-Identifier: Apache-2.0
// A picture of the block made by the server, where the browser cannot draw it.

import { t } from '../strings';
import { pictureUrl, PictureVersions } from '../link/picture_url';
import { request } from '../link/request';
import { h } from './dom';

const RENEW_MS = 3000;
const WIDTH = 960;

export class Poster {
  readonly element = h('img', {
    class: 'poster',
    alt: t('The block, drawn by the server'),
    hidden: '',
  });
  private askedMs_ = -Infinity;
  private readonly versions_ = new PictureVersions();

  constructor(private readonly session: string) {}

  /** Shows the block as it was a few seconds ago at most. */
  update(motions: number, removedMm3: number, nowMs: number): void {
    this.element.hidden = false;
    if (nowMs - this.askedMs_ < RENEW_MS) return;
    this.askedMs_ = nowMs;
    const version = this.versions_.next(motions, removedMm3);
    if (version !== null) void this.fetch_(pictureUrl(this.session, version, WIDTH));
  }

  /** The page's policy takes pictures from its own server only. */
  private async fetch_(path: string): Promise<void> {
    const response = await request(path).catch(() => null);
    if (!response?.ok) return; // the last one stays
    const { src } = this.element;
    this.element.src = URL.createObjectURL(await response.blob());
    if (src !== '') URL.revokeObjectURL(src);
  }
}
