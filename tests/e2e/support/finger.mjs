// SPDX-License-Identifier: Apache-2.0
// How a finger begins a stroke.

const REST_MS = 150;

/** A finger that has touched rests for a moment: a page waits whether a second one follows. */
export const fingerRests = () => new Promise((resolve) => setTimeout(resolve, REST_MS));
