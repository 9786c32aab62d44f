// SPDX-License-Identifier: Apache-2.0

import { setImmediate } from 'node:timers/promises';

/**
 * Waits for one turn of the event loop, in which all settled promises are handled. Unlike a timer
 * it takes no time.
 */
export const turn = (): Promise<void> => setImmediate();
