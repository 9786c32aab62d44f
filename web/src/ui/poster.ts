// SPDX-License-Identifier: Apache-2.0
// A picture of the block made by the server, where the browser cannot draw it, or not yet.

import { t } from '../strings';
import { pictureUrl, PictureVersions } from '../link/picture_url';
import { request } from '../link/request';
import type { PosterPlace } from '../model/poster_place';
import type { StateMessage } from '../wire/types';
import { h } from './dom';
import type { Picture } from './picture';

const RENEW_MS = 3000;
/**
 * Of the only picture of the block, and of one that stands there until the page has drawn its own:
 * the server mostly has that one, because the list of blocks shows it.
 */
const WIDTHS = { alone: 960, until: 480 } as const;

export class Poster {
  readonly element = h('img', {
    class: 'poster',
    alt: t('The block, drawn by the server'),
    hidden: '',
  });
  private askedMs_ = -Infinity;
  private readonly versions_ = new PictureVersions();

  constructor(private readonly session: string) {}

  /** Shows the block as it was a few seconds ago at most, where the page's own picture does not. */
  update(picture: Picture, state: StateMessage | null, nowMs: number): void {
    const place = picture.problem ? null : picture.posterPlace(nowMs);
    this.element.hidden = place === undefined;
    if (place === undefined) return;
    this.place_(place);
    if (nowMs - this.askedMs_ < RENEW_MS) return;
    this.askedMs_ = nowMs;
    const { motions = 0, removed_volume_mm3 = 0 } = state ?? {};
    const version = this.versions_.next(motions, removed_volume_mm3);
    if (version === null) return;
    void this.fetch_(pictureUrl(this.session, version, WIDTHS[place ? 'until' : 'alone']));
  }

  /** @param place where the page will draw the block; null: the picture is all there is of it */
  private place_(place: PosterPlace | null): void {
    const { element } = this;
    element.classList.toggle('placed', place !== null);
    if (place) {
      const { left, top, width } = place;
      Object.assign(element.style, { left: `${left}px`, top: `${top}px`, width: `${width}px` });
    } else element.removeAttribute('style');
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
