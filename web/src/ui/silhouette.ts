// SPDX-License-Identifier: Apache-2.0
// The silhouette of a tool as SVG, seen from the side with its tip below.

import type { OutlinePoint, ToolProfile } from '../model/tool_profile';

export const SILHOUETTE_WIDTH = 34;
export const SILHOUETTE_HEIGHT = 46;
const RADIUS_LEAST = 0.75; // of thin tools, units of the drawing
const MARGIN = 2;

/** The path of an outline and its mirror image. */
function pathOf(pieces: readonly OutlinePoint[][], scale: number): string {
  const right = pieces.flat();
  const at = ([r, z]: OutlinePoint, side: 1 | -1): string => {
    const wide = r === 0 ? 0 : Math.max(RADIUS_LEAST, r * scale);
    const x = SILHOUETTE_WIDTH / 2 + side * wide;
    const y = Math.max(-1, SILHOUETTE_HEIGHT - MARGIN - z * scale); // longer tools are cut off
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  };
  const left = [...right].reverse();
  return `M${[...right.map((p) => at(p, 1)), ...left.map((p) => at(p, -1))].join('L')}Z`;
}

/** Units of the drawing per mm, with which the widest of the tools fits. */
export function commonScale(profiles: readonly ToolProfile[]): number {
  const widest = Math.max(...profiles.map(({ radiusMm }) => radiusMm));
  return (SILHOUETTE_WIDTH / 2 - MARGIN) / widest;
}

/** Returns the drawing; all its text is made of numbers. */
export function silhouette({ pieces, body }: ToolProfile, scale: number): string {
  const holder =
    body.pieces.length === 0 ? '' : `<path class="body" d="${pathOf(body.pieces, scale)}"/>`;
  return `<svg viewBox="0 0 ${SILHOUETTE_WIDTH} ${SILHOUETTE_HEIGHT}" width="${SILHOUETTE_WIDTH}" height="${SILHOUETTE_HEIGHT}" aria-hidden="true">${holder}<path class="cutter" d="${pathOf(pieces, scale)}"/></svg>`;
}
