// SPDX-License-Identifier: Apache-2.0
// A picture of the block made by the server, where the browser cannot draw it, or not yet.

import { t } from '../strings';
import { pictureUrl, PictureVersions } from '../link/picture_url';
import { request } from '../link/request';
import type { PosterPlace } from '../model/poster_place';
import { h } from './dom';

const RENEW_MS = 3000;
/** Of the only picture of the block, and of one that stands there until the page has drawn its own:
 * that one is mostly at hand, because the list of blocks shows it. */
const WIDTHS = { alone: 960, until: 480 } as const;

export class Poster {
  readonly element = h('img', {
    class: 'poster',
    alt: t('The block, as the server draws it'),
    hidden: '',
  });
  private askedMs_ = -Infinity;
  private readonly versions_ = new PictureVersions();

  constructor(private readonly session: string) {}

  /**
   * Shows the block as it was a few seconds ago at most.
   * @param place where the page will draw the block; null: the picture is all there is of it
   */
  update(motions: number, removedMm3: number, nowMs: number, place: PosterPlace | null): void {
    const { element } = this;
    element.hidden = false;
    element.classList.toggle('placed', place !== null);
    if (place) {
      const { left, top, width } = place;
      Object.assign(element.style, { left: `${left}px`, top: `${top}px`, width: `${width}px` });
    } else element.removeAttribute('style');
    if (nowMs - this.askedMs_ < RENEW_MS) return;
    this.askedMs_ = nowMs;
    const version = this.versions_.next(motions, removedMm3);
    if (version !== null)
      void this.fetch_(pictureUrl(this.session, version, WIDTHS[place ? 'until' : 'alone']));
  }

  hide(): void {
    this.element.hidden = true;
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
