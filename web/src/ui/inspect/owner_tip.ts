// SPDX-License-Identifier: Apache-2.0
// Beside the pointer, while the surface is colored by person: who cut the place under it, with which
// tool and when. A press, and the key Enter for the middle of the picture, ask the same.

import { t } from '../../strings';
import { probe } from '../../link/probe';
import type { Cut } from '../../link/probe';
import { Hover } from '../../model/hover';
import type { PicturePlace } from '../../model/hover';
import type { SessionModel } from '../../model/session';
import { toolName } from '../../model/tool_profile';
import type { Authors } from '../authors';
import { h, setText } from '../dom';
import { moment, sentence } from '../format';
import type { Picked } from './picker';

export interface OwnerTipHost {
  model: SessionModel;
  session: string;
  /** As large as the picture. */
  parent: HTMLElement;
  authors: Authors;
  /** Of the legend. */
  colorOf: (participant: number) => string;
  /** What of the surface is at a place of the picture. */
  pick: (x: number, y: number) => Picked | null;
}

export class OwnerTip {
  private readonly dot_ = h('span', { class: 'owner-color', 'aria-hidden': 'true' });
  private readonly name_ = h('b');
  private readonly detail_ = h('small');
  private readonly mark_ = h('div', { class: 'owner-mark' });
  private readonly text_ = h(
    'div',
    { class: 'owner-tip', role: 'status' },
    this.dot_,
    this.name_,
    this.detail_,
  );
  private readonly hover_ = new Hover();
  private view_ = '';

  constructor(private readonly host: OwnerTipHost) {
    this.hide_();
    host.parent.append(this.mark_, this.text_);
  }

  /** The pointer is at this place of the picture, CSS pixels, and presses nothing. */
  move(x: number, y: number, nowMs: number): void {
    if (this.hover_.move({ x, y }, nowMs)) this.hide_();
  }

  press(x: number, y: number): void {
    this.hover_.press({ x, y });
    this.hide_();
  }

  leave(): void {
    this.hover_.leave();
    this.hide_();
  }

  /**
   * Asks where that is due; called some times a second while the colors are shown.
   * @param surface differs when the displayed surface does
   * @param view differs when the camera does
   */
  update(surface: string, view: string, nowMs: number): void {
    if (view !== this.view_) {
      this.view_ = view;
      this.hover_.restart(nowMs);
      this.hide_();
    }
    const record = this.host.model.state?.at?.record ?? null;
    const place = this.hover_.due(`${surface} ${record}`, nowMs);
    if (place) void this.ask_(place, record);
  }

  private async ask_(place: PicturePlace, record: number | null): Promise<void> {
    const { session, authors } = this.host;
    const picked = this.host.pick(place.x, place.y);
    try {
      const found = picked && (await probe(session, picked.point, picked.normal, record));
      const cut = found?.cut;
      if (cut && !authors.knows(cut.participant)) await authors.load();
      if (!this.hover_.answered(place)) return;
      if (!found) this.hide_();
      else if (cut) this.show_(place, this.nameOf_(cut), this.detailOf_(cut), cut.participant);
      else this.show_(place, t('Original stock surface, not cut yet.'), '', null);
    } catch (problem) {
      if (this.hover_.answered(place))
        this.show_(place, sentence((problem as Error).message), '', null);
    }
  }

  private nameOf_({ participant, program }: Cut): string {
    return program?.name ?? this.host.authors.nameOf(participant);
  }

  private detailOf_({ tool, beginMs, program }: Cut): string {
    const what = program && program.line > 0 ? t('line {0}', program.line) : t('stroke');
    return [toolName(this.host.model.tool(tool)), what, moment(beginMs, Date.now())].join(' · ');
  }

  private show_(place: PicturePlace, name: string, detail: string, owner: number | null): void {
    for (const one of [this.mark_, this.text_]) {
      one.style.setProperty('--x', `${place.x}px`);
      one.style.setProperty('--y', `${place.y}px`);
      one.hidden = false;
    }
    this.dot_.hidden = owner === null;
    if (owner !== null) this.dot_.setAttribute('style', `background:${this.host.colorOf(owner)}`);
    setText(this.name_, name);
    setText(this.detail_, detail);
  }

  private hide_(): void {
    this.mark_.hidden = true;
    this.text_.hidden = true;
  }
}
