// SPDX-License-Identifier: Apache-2.0
// Brings the path of the hand to the server, in order, as fast as the server takes it. Leaving
// takes effect when the whole path is sent.

import type { AgentLink } from './carve_link';
import type { Count } from './gestures';
import type { Sampler } from './sampler';

const STEP_MS = 8;

export class Delivery {
  private timer_: ReturnType<typeof setInterval> | undefined;
  private leaves_ = false;

  /** `hasEnded`: the session has, so that nothing more can be sent. */
  constructor(
    private readonly link: Pick<
      AgentLink,
      'takes' | 'waiting' | 'status' | 'send' | 'ask' | 'change' | 'accepted' | 'join' | 'leave'
    >,
    private readonly path: Pick<Sampler, 'take' | 'takeRequests' | 'waiting' | 'forget'>,
    private readonly hasEnded: () => boolean,
  ) {}

  /** Joins the session, or stays in it if the last path is not sent yet. */
  join(): void {
    this.leaves_ = false;
    this.link.join();
    this.timer_ ??= setInterval(() => this.step(), STEP_MS);
  }

  /** Leaves the session once all is sent. */
  leave(): void {
    this.leaves_ = true;
    this.step();
  }

  /** Whether nothing of the path waits. */
  get isSent(): boolean {
    return this.path.waiting === 0 && this.link.waiting === 0;
  }

  /** Sends the part of the path that is due. */
  step(): void {
    const { link, path } = this;
    if (link.takes) {
      link.send(path.take(Math.round(performance.now() * 1000)));
      const count: Count = (from, to) => link.accepted(from, to);
      for (const request of path.takeRequests(count)) {
        if (request.type === 'tool') link.ask(request);
        else link.change(request.undone, request.strokes, request.failed);
      }
    }
    const isDone = this.isSent || link.status === 'off' || this.hasEnded();
    if (this.leaves_ && isDone) this.stop_();
  }

  private stop_(): void {
    clearInterval(this.timer_);
    this.timer_ = undefined;
    this.path.forget();
    this.link.leave();
  }
}
