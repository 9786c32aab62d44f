// SPDX-License-Identifier: Apache-2.0
// Icons as SVG: 24-unit squares in the text color.

function icon(path: string): string {
  return `<svg viewBox="0 0 24 24" width="20" height="20" fill="none" stroke="currentColor" stroke-width="1.7"
    stroke-linecap="round" stroke-linejoin="round" aria-hidden="true">${path}</svg>`;
}

/** Returns a cube with one face filled, for the preset view of that side. */
function cube(face: string): string {
  return icon(
    `<path d="M12 3l8 4.5v9L12 21l-8-4.5v-9z"/><path d="M4 7.5l8 4.5 8-4.5M12 12v9"/>${face}`,
  );
}

export const ICONS = {
  fit: icon(
    '<path d="M4 9V5a1 1 0 0 1 1-1h4M15 4h4a1 1 0 0 1 1 1v4M20 15v4a1 1 0 0 1-1 1h-4M9 20H5a1 1 0 0 1-1-1v-4"/><circle cx="12" cy="12" r="2.5"/>',
  ),
  iso: cube(''),
  front: cube(
    '<path d="M4 7.5l8 4.5v9l-8-4.5z" fill="currentColor" fill-opacity=".45" stroke="none"/>',
  ),
  right: cube(
    '<path d="M20 7.5l-8 4.5v9l8-4.5z" fill="currentColor" fill-opacity=".45" stroke="none"/>',
  ),
  top: cube(
    '<path d="M12 3l8 4.5-8 4.5-8-4.5z" fill="currentColor" fill-opacity=".45" stroke="none"/>',
  ),
  carve: icon(
    '<path d="M14.500 3.500l6 6-7.500 7.500-6-6zM7 11l-2.500 7.500L12 17"/><path d="M3.500 21h8"/>',
  ),
  headset: icon(
    '<path d="M3 9a2 2 0 0 1 2-2h14a2 2 0 0 1 2 2v6a2 2 0 0 1-2 2h-3.500l-2-2.500h-3L8.500 17H5a2 2 0 0 1-2-2z"/><path d="M7.500 11.500h2M14.500 11.500h2"/>',
  ),
  arrows: icon('<path d="M5 19L17 7M10 7h7v7"/>'),
  program: icon(
    '<path d="M6 3h9l4 4v14H6zM14 3v5h5"/><path d="M9 12h3M9 16h7"/><path d="M15 11l2 1.500-2 1.500"/>',
  ),
  timeline: icon(
    '<path d="M3.500 7h10M9 12h8M3.500 17h5M13.500 3.500v17"/><circle cx="13.500" cy="3.500" r="1.200" fill="currentColor"/>',
  ),
  inspect: icon('<path d="M3.500 15.500l12-12 5 5-12 12zM7 12l2 2M10 9l2.500 2.500M13 6l2 2"/>'),
  help: icon(
    '<circle cx="12" cy="12" r="9"/><path d="M9.5 9.5a2.5 2.5 0 1 1 3.6 2.200c-.8.4-1.100.9-1.100 1.800M12 16.700v.1"/>',
  ),
  link: icon(
    '<path d="M10 14a4 4 0 0 0 5.700 0l3-3A4 4 0 0 0 13 5.300l-1 1M14 10a4 4 0 0 0-5.700 0l-3 3A4 4 0 0 0 11 18.700l1-1"/>',
  ),
  invite: icon(
    '<circle cx="10" cy="8" r="3.5"/><path d="M3.5 20a6.5 6.5 0 0 1 13 0M18.5 7v6M15.5 10h6"/>',
  ),
  undo: icon('<path d="M8 5L4 9l4 4"/><path d="M4 9h9.500a5.500 5.500 0 0 1 0 11H8"/>'),
  upload: icon('<path d="M12 16V5m0 0l-4 4m4-4l4 4M5 20h14"/>'),
  download: icon('<path d="M12 4v11m0 0l-4-4m4 4l4-4M5 20h14"/>'),
  follow: icon(
    '<circle cx="12" cy="12" r="6.5"/><circle cx="12" cy="12" r="1.5" fill="currentColor"/><path d="M12 2.5v3M12 18.5v3M2.5 12h3M18.5 12h3"/>',
  ),
  sound: icon(
    '<path d="M4 9.500v5h3.500L12 18.500v-13L7.500 9.500zM15.500 9a4.200 4.200 0 0 1 0 6M18 6.500a7.800 7.800 0 0 1 0 11"/>',
  ),
  back: icon('<path d="M15 5l-7 7 7 7"/>'),
};
