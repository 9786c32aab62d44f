// SPDX-License-Identifier: Apache-2.0
// The card that is shown before there is a block.

import { useSignal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import { t } from '../strings';
import { ageText } from '../model/new_block';
import { ToolRack, ToolRackView } from '../ui/tools/tool_rack';
import type { ToolInfo } from '../wire/types';
import { forgetStrokes, keptStrokes } from './autosave';
import type { KeptStrokes } from './autosave';
import { EXAMPLE_TOOLS } from './example';
import type { GivenFile } from './program_block';

export interface StartActions {
  choose: () => void;
  example: () => void;
  /** Carves a block by hand with these tools. */
  carve: (tools: readonly ToolInfo[]) => void;
  /** Opens the file of strokes that the browser has kept. */
  goOn: (file: GivenFile) => void;
}

function Button({ text, press }: { text: string; press: () => void }) {
  return (
    <button type="button" class="button" onClick={press}>
      {text}
    </button>
  );
}

/** Offers strokes of a page that was closed before they were in a file. */
function Offer({ goOn }: Pick<StartActions, 'goOn'>) {
  const kept = useSignal<KeptStrokes | null>(null);
  useEffect(() => {
    keptStrokes().then(
      (strokes) => (kept.value = strokes),
      (problem: unknown) => console.warn(problem), // the browser stores nothing
    );
  }, []);
  const { value: strokes } = kept;
  const end = (act: () => void) => () => {
    kept.value = null;
    act();
  };
  return (
    <div class="kept-strokes" role="status">
      {strokes && (
        <>
          <p>{t('You have unsaved strokes from {0}.', ageText(strokes.atMs, Date.now()))}</p>
          <div class="page-actions">
            <Button text={t('Restore')} press={end(() => goOn(strokes))} />
            <Button text={t('Discard')} press={end(() => void forgetStrokes())} />
          </div>
        </>
      )}
    </div>
  );
}

interface StartCardProps extends StartActions {
  hidden: boolean;
}

export function StartCard({ choose, example, carve, goOn, hidden }: StartCardProps) {
  const rack = useMemo(() => new ToolRack(EXAMPLE_TOOLS), []);
  return (
    <section class="start" aria-label={t('Without a server')} hidden={hidden}>
      <Offer goOn={goOn} />
      <h2>{t('Drop an NC program or a KERF file here')}</h2>
      <p>
        {t(
          'G-code, Klartext or APT. You can add a scene (JSON) or a model as stock (STL, PLY, OBJ). Everything stays in this browser: nothing is uploaded.',
        )}
      </p>
      <div class="page-actions">
        <Button text={t('Choose files…')} press={choose} />
        <Button text={t('Try an example')} press={example} />
        <Button text={t('Carve a block by hand')} press={() => carve(rack.tools)} />
      </div>
      <details class="start-tools">
        <summary>{t('Tools for carving by hand')}</summary>
        <ToolRackView rack={rack} />
      </details>
    </section>
  );
}
