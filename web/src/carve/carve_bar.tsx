// SPDX-License-Identifier: Apache-2.0
// The bar below the picture while one carves: the rack of tools, how the tool follows, its depth,
// undo, and messages.

import { useSignal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { t } from '../strings';
import './carve.css';
import { toolName, toolProfile } from '../model/tool_profile';
import { DIAMETER_MM, diameterOf, PALETTE, withShape } from '../model/tool_sizes';
import { shapeName } from '../strings/names';
import { figure } from '../ui/format';
import type { ToolInfo } from '../wire/types';
import type { AimMode, AxisChoice } from './aim';
import type { DragStrength } from './drag';
import { useCovering } from '../ui/shell';
import type { Shell } from '../ui/shell';
import { commonScale, silhouette } from '../ui/silhouette';
import type { Notes } from './notes';
import { StrokeChoicesView } from './stroke_choices';
import type { StrokeChoices } from './stroke_choices';
import type { ToolSettings } from './tool_settings';

const MODES: readonly [AimMode, string, string][] = [
  ['surface', t('Surface'), t('The tip follows the surface as it was before this stroke (P)')],
  ['plane', t('Plane'), t('The tip stays on the plane where the stroke began (P)')],
];
const AXES: Record<AxisChoice, string> = {
  surface: t('Axis: surface'),
  vertical: t('Axis: vertical'),
  pen: t('Axis: pen'),
};
const DRAGS: Record<DragStrength, string> = {
  off: t('Resistance: off'),
  light: t('Resistance: light'),
  strong: t('Resistance: strong'),
};
const SLIDER_STEPS = 1000;
/** As which the shapes are drawn. */
const SHOWN_MM = 6;
const SHOWN: ToolInfo = { id: 0, shape: 'ball', diameter_mm: SHOWN_MM, length_mm: 12 };

export function isTouched(): boolean {
  return matchMedia('(pointer: coarse)').matches;
}

interface PressProps {
  label: string;
  title: string;
  isPressed?: boolean;
  class?: string;
  press: () => void;
}

function Press({ label, title, isPressed, class: name, press }: PressProps) {
  return (
    <button type="button" title={title} class={name} aria-pressed={isPressed} onClick={press}>
      {label}
    </button>
  );
}

interface ToolProps {
  tool: ToolInfo;
  /** As SVG; its text is made of numbers. */
  drawing: string;
  isChosen: boolean;
  choose: () => void;
}

function Tool({ tool, drawing, isChosen, choose }: ToolProps) {
  const button = useRef<HTMLButtonElement>(null);
  useLayoutEffect(() => {
    if (isChosen) button.current?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }, [isChosen]);
  const name = toolName(tool);
  return (
    <button
      ref={button}
      type="button"
      class="carve-tool"
      title={name}
      aria-pressed={isChosen}
      onClick={choose}
    >
      <span style="display: contents" dangerouslySetInnerHTML={{ __html: drawing }} />
      <span>{name}</span>
    </button>
  );
}

function Rack({ settings }: { settings: ToolSettings }) {
  const { tools } = settings;
  const profiles = tools.map(toolProfile);
  const scale = commonScale(profiles);
  return (
    <div class="carve-rack" role="group" aria-label={t('Tool')}>
      {tools.map((tool, n) => (
        <Tool
          key={tool.id}
          tool={tool}
          drawing={silhouette(profiles[n]!, scale)}
          isChosen={tool.id === settings.tool?.id}
          choose={() => settings.chooseTool(tool.id)}
        />
      ))}
    </div>
  );
}

/** The shapes of tools that can be made, and the diameter: of the tool that the hand gets next. */
function Shapes({ settings }: { settings: ToolSettings }) {
  const { wish } = settings;
  const mm = wish && diameterOf({ ...wish, id: 0 });
  return (
    <div class="carve-shapes">
      <div class="carve-modes" role="group" aria-label={t('Shape')}>
        {PALETTE.map((shape) => {
          const profile = toolProfile({ id: 0, ...withShape(SHOWN, shape, SHOWN_MM) });
          return (
            <button
              key={shape}
              type="button"
              class="carve-shape"
              title={shapeName(shape)}
              aria-label={shapeName(shape)}
              aria-pressed={wish?.shape === shape}
              onClick={() => settings.chooseShape(shape)}
              dangerouslySetInnerHTML={{ __html: silhouette(profile, commonScale([profile])) }}
            />
          );
        })}
      </div>
      {mm !== null && (
        <label class="carve-diameter" title={t('Diameter of the tool ([ and ])')}>
          <span aria-hidden="true">⌀</span>
          <input
            type="number"
            step="any"
            aria-label={t('Diameter, mm')}
            min={DIAMETER_MM.least}
            max={DIAMETER_MM.most}
            value={mm}
            onChange={({ currentTarget }) => {
              const { valueAsNumber: typed } = currentTarget;
              if (Number.isFinite(typed)) settings.setDiameter(typed);
              currentTarget.value = String(settings.wish?.diameter_mm ?? mm);
            }}
          />
          <span>mm</span>
        </label>
      )}
    </div>
  );
}

/** The depth: equal distances on the slider are equal factors. */
function Depth({ settings }: { settings: ToolSettings }) {
  const { mm, least, most } = settings.depth.value;
  const part = Math.log(mm / least) / Math.log(most / least);
  const text = `${figure(mm)} mm`;
  return (
    <div class="carve-depth">
      <span>{t('Depth')}</span>
      <input
        type="range"
        min={0}
        max={SLIDER_STEPS}
        aria-label={t('Depth')}
        aria-valuetext={text}
        title={t('Depth below the surface (Ctrl + wheel, or pen pressure)')}
        value={Math.round(SLIDER_STEPS * part)}
        onInput={({ currentTarget }) => {
          const share = Number(currentTarget.value) / SLIDER_STEPS;
          settings.setDepth(least * (most / least) ** share);
        }}
      />
      <output class="carve-depth-value">{text}</output>
    </div>
  );
}

export interface BarProps {
  shell: Shell;
  settings: ToolSettings;
  choices: StrokeChoices;
  notes: Notes;
  /** A 3D mouse; null: the browser can have none. */
  spaceMouse: { isThere: ReadonlySignal<boolean>; choose: () => void } | null;
  undo: () => void;
  redo: () => void;
  done: () => void;
}

function Controls({ settings, choices, spaceMouse, undo, redo, done }: BarProps) {
  const { value: mode } = settings.mode;
  const { value: drag } = settings.drag;
  const { value: axis } = settings.axis;
  const isOpen = useSignal(false); // on phones, where the picture needs the place
  return (
    <div class="carve-controls">
      <div class={`carve-choices${isOpen.value ? ' open' : ''}`}>
        <div class="carve-modes" role="group" aria-label={t('The tip follows')}>
          {MODES.map(([one, label, title]) => (
            <Press
              key={one}
              {...{ label, title }}
              isPressed={one === mode}
              press={() => settings.chooseMode(one)}
            />
          ))}
        </div>
        <Press
          label={AXES[axis]}
          title={t('The axis of the tool: across the surface, vertical, or as the pen (L)')}
          isPressed={axis !== 'surface'}
          press={() => settings.nextAxis()}
        />
        <Press
          label={DRAGS[drag]}
          title={t('Holds the tool back in heavy cuts: off, light or strong (D)')}
          isPressed={drag !== 'off'}
          press={() => settings.nextDrag()}
        />
        {settings.mayMake && <Shapes settings={settings} />}
        <StrokeChoicesView choices={choices} />
        {spaceMouse && (
          <Press
            label={t('3D mouse')}
            title={t('Connect a 3D mouse: the cap moves and leans the tool, the left button cuts')}
            isPressed={spaceMouse.isThere.value}
            press={spaceMouse.choose}
          />
        )}
      </div>
      <Depth settings={settings} />
      <Press
        label={t('Undo')}
        title={t('Undo your last stroke (Ctrl+Z, or tap with two fingers)')}
        press={undo}
      />
      <Press
        label={t('Redo')}
        title={t('Redo (Ctrl+Shift+Z, or tap with three fingers)')}
        press={redo}
      />
      <Press
        label={t('More')}
        title={t('More settings of the tool')}
        class="carve-more"
        isPressed={isOpen.value}
        press={() => (isOpen.value = !isOpen.value)}
      />
      <Press
        label={t('Done')}
        title={t('Done: stop carving (Esc)')}
        class="carve-done"
        press={done}
      />
    </div>
  );
}

export function CarveBar(props: BarProps) {
  const element = useCovering<HTMLElement>(props.shell, '--carve-bar');
  const { text, isProblem } = props.notes.shown;
  return (
    <section ref={element} class="carve-bar" aria-label={t('Carve')}>
      <Rack settings={props.settings} />
      <Controls {...props} />
      <p class={isProblem ? 'carve-note problem' : 'carve-note'} role="status">
        {text}
      </p>
    </section>
  );
}
