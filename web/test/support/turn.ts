// SPDX-License-Identifier: Apache-2.0

import { setImmediate } from 'node:timers/promises';

/**
 * One turn of the event loop: what waited for what is there already has gone on. Unlike a timer it
 * takes no time.
 */
export const turn = (): Promise<void> => setImmediate();
