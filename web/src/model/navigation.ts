// SPDX-License-Identifier: Apache-2.0
// What dragging with the middle and the right mouse button does: as in the program that somebody is
// used to. The left button turns in all of them.

export type Drag = 'rotate' | 'pan' | 'zoom';

export interface Navigation {
  id: string;
  /** Of the programs, the same in every language. */
  name: string;
  middle: Drag;
  right: Drag;
  /** The button and the key with which it zooms instead. With other keys turning pans, and panning turns. */
  zoom?: { button: 'middle' | 'right'; key: 'shiftKey' | 'ctrlKey' };
}

/** The first one is the default. */
export const NAVIGATIONS: readonly Navigation[] = [
  { id: 'kerf', name: 'Kerf', middle: 'zoom', right: 'pan' },
  {
    id: 'blender',
    name: 'Blender, NX',
    middle: 'rotate',
    right: 'pan',
    zoom: { button: 'middle', key: 'ctrlKey' },
  },
  { id: 'fusion', name: 'Fusion, Inventor', middle: 'pan', right: 'pan' },
  {
    id: 'solidworks',
    name: 'SolidWorks',
    middle: 'rotate',
    right: 'pan',
    zoom: { button: 'middle', key: 'shiftKey' },
  },
  { id: 'onshape', name: 'Onshape', middle: 'pan', right: 'rotate' },
  {
    id: 'rhino',
    name: 'Rhino',
    middle: 'pan',
    right: 'rotate',
    zoom: { button: 'right', key: 'ctrlKey' },
  },
];

export function navigationOf(id: string | null): Navigation {
  return NAVIGATIONS.find((one) => one.id === id) ?? NAVIGATIONS[0]!;
}

/** What a button does that is pressed with these keys. */
export function dragOf(
  { middle, right, zoom }: Navigation,
  button: 'middle' | 'right',
  keys: { shiftKey: boolean; ctrlKey: boolean },
): Drag {
  if (zoom?.button === button && keys[zoom.key]) return 'zoom';
  return button === 'middle' ? middle : right;
}
