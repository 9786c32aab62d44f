// SPDX-License-Identifier: Apache-2.0

/** The state of the connection to the session. */
export type LinkStatus = 'connecting' | 'connected' | 'reconnecting' | 'stopped';
