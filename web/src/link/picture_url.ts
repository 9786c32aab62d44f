// SPDX-License-Identifier: Apache-2.0
// Addresses of pictures of blocks, which the server draws.

/** `version` tells the states of the block apart for the browser. */
export function pictureUrl(
  session: string,
  version: string,
  width: number,
  height: number,
): string {
  const query = `width=${width}&height=${height}&version=${version}`;
  return `/v1/sessions/${encodeURIComponent(session)}/picture.png?${query}`;
}

/**
 * When a picture is to be asked for: after each change, and once more when the block is at rest,
 * because a picture of a block that changes may be older than its request.
 */
export class PictureVersions {
  private motions_ = -1;
  private atRest_ = false;

  /** The version to ask for, now that the block has had so many motions; null: none. */
  next(motions: number): string | null {
    const changed = motions !== this.motions_;
    if (!changed && this.atRest_) return null;
    this.atRest_ = !changed;
    this.motions_ = motions;
    return changed ? `${motions}` : `${motions}-at-rest`;
  }
}
