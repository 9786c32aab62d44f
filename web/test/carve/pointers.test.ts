// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { Pointers } from '../../src/carve/pointers';

interface Fields {
  pointerId?: number;
  pointerType?: string;
  button?: number;
  buttons?: number;
  pressure?: number;
  tiltX?: number;
  tiltY?: number;
  shiftKey?: boolean;
  altKey?: boolean;
  places?: [number, number][];
}

describe('pointers', () => {
  let listeners: Map<string, (event: unknown) => void>;
  let log: string[];
  let stopped: number;
  let pointers: Pointers;

  beforeEach(() => {
    listeners = new Map();
    log = [];
    stopped = 0;
    const canvas = {
      addEventListener: (
        name: string,
        act: (event: unknown) => void,
        options: AddEventListenerOptions,
      ) => {
        expect(options.capture).toBe(true); // before the camera's controls
        listeners.set(name, act);
        options.signal!.addEventListener('abort', () => listeners.delete(name));
      },
      setPointerCapture: (id: number) => log.push(`capture ${id}`),
    };
    pointers = new Pointers(canvas as unknown as HTMLElement, {
      hover: (place) => log.push(place ? `hover ${place.x},${place.y}` : 'hover nothing'),
      begin: ({ x, y, pressure, tilt }, onPlane) => {
        if (onPlane) log.push('on its plane');
        log.push(`begin ${x},${y} ${pressure}`);
        if (tilt) log.push(`tilt ${tilt.map((part) => part.toFixed(3)).join(' ')}`);
      },
      move: (places) => log.push(`move ${places.map(({ x, y }) => `${x},${y}`).join(' ')}`),
      end: () => log.push('end'),
      holdPlane: vi.fn(),
      deepen: (factor) => log.push(factor > 1 ? 'deeper' : 'less deep'),
      turn: vi.fn(),
      pan: vi.fn(),
      undo: vi.fn(),
      redo: vi.fn(),
    });
  });

  function send(type: string, fields: Fields = {}): void {
    const { places = [[0, 0]], ...others } = fields;
    const one = ([offsetX, offsetY]: [number, number]) => ({
      ...{ type, pointerId: 1, pointerType: 'mouse', button: 0, buttons: 0, pressure: 0.5 },
      ...{ tiltX: 0, tiltY: 0, shiftKey: false, altKey: false },
      ...others,
      offsetX,
      offsetY,
    });
    listeners.get(type)?.({
      ...one(places.at(-1)!),
      getCoalescedEvents: () => places.map(one),
      stopImmediatePropagation: () => (stopped += 1),
    });
  }

  it('goes on along a straight line with Shift, in the direction in which it leaves', () => {
    send('pointerdown', { places: [[10, 10]] });
    send('pointermove', { shiftKey: true, places: [[15, 12]] });
    send('pointermove', {
      shiftKey: true,
      places: [
        [30, 10],
        [50, 40],
      ],
    });
    send('pointermove', { places: [[60, 45]] });
    send('pointermove', { shiftKey: true, places: [[60, 65]] });
    send('pointermove', { shiftKey: true, places: [[90, 75]] });
    expect(log.slice(2)).toEqual(['move 30,10 50,10', 'move 60,45', 'move 60,65', 'move 60,75']);
  });

  it('begins on a plane with Alt', () => {
    send('pointerdown', { altKey: true, places: [[10, 10]] });
    expect(log).toContain('on its plane');
  });

  it('carves with the left button, with every place between two frames', () => {
    send('pointermove', { places: [[5, 5]] });
    send('pointerdown', { places: [[6, 5]] });
    send('pointermove', {
      buttons: 1,
      places: [
        [7, 5],
        [8, 6],
      ],
    });
    send('pointerup');
    expect(log).toEqual(['hover 5,5', 'capture 1', 'begin 6,5 null', 'move 7,5 8,6', 'end']);
    expect(stopped).toBe(3); // the camera gets none of them, but the hover
  });

  it('leaves other buttons, and the left one while Space is held, to the camera', () => {
    send('pointerdown', { button: 2 });
    send('pointermove', { buttons: 2 });
    pointers.spaceHeld = true;
    send('pointerdown');
    send('pointermove', { buttons: 1 });
    pointers.spaceHeld = false;
    expect(stopped).toBe(0);
    expect(new Set(log)).toEqual(new Set(['hover nothing']));
  });

  it('tells the pressure of a pen', () => {
    send('pointerdown', { pointerType: 'pen', pressure: 0.25 });
    expect(log.at(-1)).toBe('begin 0,0 0.25');
  });

  it('tells how a pen leans', () => {
    send('pointerdown', { pointerType: 'pen', tiltX: 45, tiltY: 0 });
    send('pointerup');
    expect(log.at(-2)).toBe('tilt 0.707 0.000');
    send('pointerdown', { pointerType: 'pen', tiltX: -30, tiltY: 90 });
    const [right, down] = log.at(-1)!.split(' ').slice(1).map(Number);
    expect([Math.sign(right!), down! > 0.99]).toEqual([-1, true]);
    pointers.cancel();
    send('pointerdown', { pointerType: 'pen', tiltX: 0, tiltY: 0 }); // one that cannot tell
    expect(log.at(-1)).toBe('begin 0,0 0.5');
  });

  it('ends the stroke when the browser takes the pointer away, and when it is asked to', () => {
    send('pointerdown');
    send('pointercancel');
    expect(log.at(-1)).toBe('end');
    expect(pointers.cancel()).toBe(false);
    send('pointerdown');
    expect(pointers.cancel()).toBe(true);
    expect(log.at(-1)).toBe('end');
    log.length = 0;
    send('pointermove', { buttons: 1 });
    expect(log).toEqual(['hover nothing']);
  });

  it('changes the depth with Ctrl and the wheel, and leaves the wheel to the camera', () => {
    const wheel = listeners.get('wheel')!;
    const stop = vi.fn();
    const event = { deltaY: -100, preventDefault: stop, stopImmediatePropagation: stop };
    wheel({ ...event, ctrlKey: false });
    expect(stop).not.toHaveBeenCalled();
    wheel({ ...event, ctrlKey: true });
    expect(stop).toHaveBeenCalledTimes(2);
    wheel({ ...event, deltaY: 100, ctrlKey: true });
    expect(log).toEqual(['deeper', 'less deep']);
  });

  it('carves with a finger, and keeps fingers from the camera', () => {
    send('pointerdown', { pointerType: 'touch', places: [[10, 10]] });
    send('pointermove', { pointerType: 'touch', places: [[40, 10]] });
    send('pointerup', { pointerType: 'touch' });
    expect(log).toEqual(['begin 10,10 null', 'move 40,10', 'end']);
    expect(stopped).toBe(3);
  });

  it('leaves nothing behind', () => {
    send('pointerdown');
    pointers.dispose();
    expect(log.at(-1)).toBe('end');
    expect(listeners.size).toBe(0);
  });
});
