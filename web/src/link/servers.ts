// SPDX-License-Identifier: Apache-2.0
// The servers that may go on with a session, and which of them a connection tries next.

import { redirectTarget } from './redirect';

/** The same WebSocket at another server; null: its address is not to be followed (`redirectTarget`). */
function socketAt(url: string, server: string): string | null {
  const target = redirectTarget(url.replace(/^ws/, 'http'), server);
  return target?.replace(/^http/, 'ws') ?? null;
}

export class Servers {
  private urls_: string[];
  private at_ = 0;
  private isSent_ = false; // from server to server, without a welcome

  /** @param home address of the WebSocket at the server that the page comes from */
  constructor(private readonly home: string) {
    this.urls_ = [home];
  }

  /** Of the WebSocket to be opened. */
  get url(): string {
    return this.urls_[this.at_]!;
  }

  /** The origin of the server at which that is. */
  get server(): string {
    return new URL(this.url.replace(/^ws/, 'http')).origin;
  }

  /** The server has accepted the connection, and names others. */
  welcomed(others: readonly string[]): void {
    const { url } = this;
    const known = others.flatMap((server) => socketAt(url, server) ?? []);
    this.urls_ = [...new Set([url, ...known, this.home])];
    this.at_ = 0;
    this.isSent_ = false;
  }

  /**
   * The connection has ended. Returns whether to connect at once: a server has named the one that has
   * the session. Of servers that do not answer each is tried.
   * @param redirect whom it has named; empty: nobody
   */
  lost(redirect: string, wasWelcomed: boolean): boolean {
    const named = redirect === '' ? null : socketAt(this.url, redirect);
    if (named === null) {
      if (!wasWelcomed) this.at_ = (this.at_ + 1) % this.urls_.length;
      return false;
    }
    this.urls_ = [...new Set([named, ...this.urls_])];
    this.at_ = 0;
    const isFirst = !this.isSent_; // two that name each other are not asked without a pause
    this.isSent_ = true;
    return isFirst;
  }
}
