// SPDX-License-Identifier: Apache-2.0
// What dragging with the middle and the right mouse button does: as in the program that somebody is
// used to. The left button turns in all of them.

export type Drag = 'rotate' | 'pan' | 'zoom' | 'none';

interface Keys {
  shiftKey: boolean;
  ctrlKey: boolean;
}

export interface Navigation {
  id: string;
  /** Of the programs, the same in every language. */
  name: string;
  middle: Drag;
  right: Drag;
  /** The button and the key with which it zooms instead. With other keys turning pans, and panning turns. */
  zoom?: { button: 'middle' | 'right'; key: 'shiftKey' | 'ctrlKey' };
  /** While the middle button is held, another button changes its action (`Chord`). */
  chord?: true;
  /** The right button's other actions, by modifier key. */
  rightWith?: { shift: Drag; ctrl: Drag; both: Drag };
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
    id: 'freecad', // its style “CAD”, where the right button alone opens a menu
    name: 'FreeCAD',
    middle: 'pan',
    right: 'none',
    chord: true,
    rightWith: { shift: 'rotate', ctrl: 'pan', both: 'zoom' },
  },
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

/**
 * The action to set in the controls for a button that is pressed with these keys: with one of them
 * they pan instead of turning, and turn instead of panning.
 */
export function dragOf(
  { middle, right, zoom, rightWith }: Navigation,
  button: 'middle' | 'right',
  keys: Keys,
): Drag {
  if (button === 'right' && rightWith && (keys.shiftKey || keys.ctrlKey)) {
    if (keys.shiftKey && keys.ctrlKey) return rightWith.both;
    return exchanged(keys.shiftKey ? rightWith.shift : rightWith.ctrl);
  }
  if (zoom?.button === button && keys[zoom.key]) return 'zoom';
  return button === 'middle' ? middle : right;
}

function exchanged(drag: Drag): Drag {
  if (drag === 'rotate') return 'pan';
  return drag === 'pan' ? 'rotate' : drag;
}

const [LEFT, RIGHT, MIDDLE] = [1, 2, 4]; // bits of `buttons` of an event
/** A click; FreeCAD takes the time of a double click. */
const CLICK_MS = 400;

/**
 * What dragging with the middle button does as in FreeCAD: it pans, turns while the left or the right
 * button is held too, and zooms after a click of one of them.
 */
export class Chord {
  private addedMs_: number | null = null; // since when another button is held
  private zooms_ = false;

  /** The middle button was pressed. */
  begin(): void {
    this.addedMs_ = null;
    this.zooms_ = false;
  }

  /** @param buttons that are held; returns null when the middle one is not any more */
  drag(buttons: number, nowMs: number): Drag | null {
    if ((buttons & MIDDLE) === 0) return null;
    if (buttons & (LEFT | RIGHT)) {
      this.addedMs_ ??= nowMs;
      return 'rotate';
    }
    if (this.addedMs_ !== null) this.zooms_ = nowMs - this.addedMs_ < CLICK_MS;
    this.addedMs_ = null;
    return this.zooms_ ? 'zoom' : 'pan';
  }
}
