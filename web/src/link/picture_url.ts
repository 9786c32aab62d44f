// SPDX-License-Identifier: Apache-2.0
// Addresses of pictures of blocks, which the server draws.

/** The widths of which the server draws pictures, pixels; the height is 3/4 of it. */
export type PictureWidth = 240 | 480 | 960;

/** `version` tells the states of the block apart for the browser. */
export function pictureUrl(session: string, version: string, width: PictureWidth): string {
  const query = `width=${width}&version=${version}`;
  return `/v1/sessions/${encodeURIComponent(session)}/picture.png?${query}`;
}

/**
 * When a picture is to be asked for: after each change, and once more when the block is at rest,
 * because a picture of a block that changes may be older than its request.
 */
export class PictureVersions {
  private state_ = '';
  private atRest_ = false;

  /** The version to ask for, now that the block is in this state; null: none. Undo adds no motion. */
  next(motions: number, removedMm3: number): string | null {
    const state = `${motions}-${removedMm3}`;
    const changed = state !== this.state_;
    if (!changed && this.atRest_) return null;
    this.atRest_ = !changed;
    this.state_ = state;
    return changed ? state : `${state}-at-rest`;
  }
}
