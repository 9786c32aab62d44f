// SPDX-License-Identifier: Apache-2.0
// The first connection of a session's page, which is opened and greeted while the code of the page
// loads: that takes longer than the server's answer.

import { mark } from '../model/marks';
import { VIEW_PROTOCOL } from '../wire/types';
import { socketUrl } from './address';
import { viewBudget } from './budget';
import { helloText } from './hello';
import { personIn } from './kept_person';
import type { Socket } from './socket';
import { viewerName } from './viewer_name';

/** Keeps the events of a connection until somebody takes it, who gets them in their order. */
export class EarlySocket implements Socket {
  binaryType = 'arraybuffer';
  onopen: Socket['onopen'] = null;
  onmessage: Socket['onmessage'] = null;
  onclose: Socket['onclose'] = null;
  onerror: Socket['onerror'] = null;
  readonly isGreeted = true;
  private isTaken_ = false;
  private readonly waiting_: (() => void)[] = [];

  /** Sends `hello` as soon as `socket` is open. */
  constructor(
    private readonly socket_: Socket,
    hello: string,
  ) {
    socket_.binaryType = this.binaryType;
    socket_.onopen = (event) => {
      socket_.send(hello);
      mark('hello');
      this.pass_(() => this.onopen?.(event));
    };
    socket_.onmessage = (event) => this.pass_(() => this.onmessage?.(event));
    socket_.onclose = (event) => this.pass_(() => this.onclose?.(event));
    socket_.onerror = (event) => this.pass_(() => this.onerror?.(event));
  }

  /** From the next microtask on, the handlers that are set then get the events. */
  take(): this {
    queueMicrotask(() => {
      this.isTaken_ = true;
      for (const event of this.waiting_) event();
    });
    return this;
  }

  send(data: string | Uint8Array<ArrayBuffer>): void {
    this.socket_.send(data);
  }

  close(code?: number, reason?: string): void {
    this.socket_.close(code, reason);
  }

  private pass_(event: () => void): void {
    if (this.isTaken_) event();
    else this.waiting_.push(event);
  }
}

let early: { url: string; socket: EarlySocket } | null = null;

/** Joins the session that the page's address names, unless an invitation has to be redeemed first. */
export function joinEarly(): void {
  const parameters = new URLSearchParams(location.search);
  const session = parameters.get('session');
  if (!session || location.hash !== '') return;
  const url = socketUrl(session, 'view');
  const socket = new WebSocket(url, VIEW_PROTOCOL) as unknown as Socket;
  const { color } = personIn(session);
  const hello = helloText(viewerName(parameters), null, viewBudget(parameters), color);
  early = { url, socket: new EarlySocket(socket, hello) };
}

/** The connection of joinEarly() to `url`, once; a new one otherwise. */
export function openView(url: string, protocol: string): Socket {
  const found = early?.url === url ? early.socket.take() : null;
  early = null;
  return found ?? (new WebSocket(url, protocol) as unknown as Socket);
}
