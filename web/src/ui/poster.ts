// SPDX-License-Identifier: Apache-2.0
// A picture of the block made by the server, where the browser cannot draw it.

import { t } from '../strings';
import { pictureUrl, PictureVersions } from '../link/picture_url';
import { h } from './dom';

const RENEW_MS = 3000;
const WIDTH = 960;

export class Poster {
  readonly element = h('img', {
    class: 'poster',
    alt: t('The block, as the server draws it'),
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
    if (version !== null) this.element.src = pictureUrl(this.session, version, WIDTH);
  }
}
