// SPDX-License-Identifier: Apache-2.0
// Beside the pointer, while the surface is colored by person: who cut the place under it, with which
// tool and when. A press, and the key Enter for the middle of the picture, ask the same.

import { signal } from '@preact/signals';
import { t } from '../../strings';
import { probe } from '../../link/probe';
import type { Cut } from '../../link/probe';
import { Hover } from '../../model/hover';
import type { PicturePlace } from '../../model/hover';
import type { SessionModel } from '../../model/session';
import { toolName } from '../../model/tool_profile';
import type { Authors } from '../authors';
import { moment, sentence } from '../format';
import type { Picked } from './picker';

export interface OwnerTipHost {
  model: SessionModel;
  session: string;
  authors: Authors;
  /** Of the legend. */
  colorOf: (participant: number) => string;
  /** What of the surface is at a place of the picture. */
  pick: (x: number, y: number) => Picked | null;
}

/** Who cut a place of the picture. */
interface Answer {
  place: PicturePlace;
  name: string;
  detail: string;
  /** Null: nobody cut there, or it is not known. */
  owner: number | null;
}

export class OwnerTip {
  /** Null: nothing is shown. */
  readonly answer = signal<Answer | null>(null);
  private readonly hover_ = new Hover();
  private view_ = '';

  constructor(readonly host: OwnerTipHost) {}

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
    this.answer.value = { place, name, detail, owner };
  }

  private hide_(): void {
    this.answer.value = null;
  }
}

/** Not in the overlay, which is hidden from screen readers. */
export function OwnerTipView({ tip }: { tip: OwnerTip }) {
  const { place, name, detail, owner } = tip.answer.value ?? {};
  const isHidden = place === undefined;
  const style = place ? `--x:${place.x}px;--y:${place.y}px` : '';
  const isKnown = owner !== undefined && owner !== null;
  return (
    <>
      <div class="owner-mark" hidden={isHidden} style={style} />
      <div class="owner-tip" role="status" hidden={isHidden} style={style}>
        <span
          class="owner-color"
          aria-hidden="true"
          hidden={!isKnown}
          style={isKnown ? `background:${tip.host.colorOf(owner)}` : ''}
        />
        <b>{name}</b>
        <small>{detail}</small>
      </div>
    </>
  );
}
