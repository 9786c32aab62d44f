// SPDX-License-Identifier: Apache-2.0

/** The part of WebSocket that is used, so that tests can substitute another implementation. */
export interface Socket {
  /** The hello was sent before the socket was handed over. */
  readonly isGreeted?: boolean;
  binaryType: string;
  onopen: ((event: never) => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
  onclose: ((event: { code: number; reason: string }) => void) | null;
  onerror: ((event: never) => void) | null;
  send(data: string | Uint8Array<ArrayBuffer>): void;
  close(code?: number, reason?: string): void;
}
