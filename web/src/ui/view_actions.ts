// SPDX-License-Identifier: Apache-2.0
// The actions on the picture, of both pages: views, following, arrows, grid, projection.

import { t } from '../strings';
import type { Participants } from '../model/participants';
import type { Preset } from '../view/camera_rig';
import type { Action, ButtonAction } from './actions';
import { ICONS } from './icons';
import type { CameraKeys } from './keyboard';
import type { PersonChoice } from './person_choice';
import type { Picture } from './picture';

/** The buttons of views: the whole block, and from four sides. */
export function viewActions(picture: Picture): ButtonAction[] {
  const isDisabled = (): boolean => picture.viewer === null;
  const view = (name: Preset, label: string, key: string, icon: string): ButtonAction => ({
    ...{ name, label, key, icon, isDisabled },
    perform: () => picture.viewer?.rig.preset(name, performance.now()),
  });
  return [
    {
      ...{ name: 'fit', label: t('Show the whole block'), key: 'F', icon: ICONS.fit, isDisabled },
      perform: () => picture.viewer?.rig.fit(performance.now()),
    },
    view('iso', t('Three-quarter view'), '0', ICONS.iso),
    view('front', t('Front'), '1', ICONS.front),
    view('right', t('Right'), '3', ICONS.right),
    view('top', t('Top'), '7', ICONS.top),
  ];
}

/** The buttons for the tools in the picture. */
export function toolActions(
  picture: Picture,
  participants: Participants,
  people: PersonChoice,
): ButtonAction[] {
  return [
    {
      ...{ name: 'follow', label: t('Follow the next tool'), key: 'N', icon: ICONS.follow },
      isDisabled: () => picture.viewer === null || participants.carvers().length === 0,
      isPressed: () => picture.followed !== null,
      perform: () => people.followNext(),
    },
    {
      ...{ name: 'arrows', label: t('Force and torque arrows'), key: 'A', icon: ICONS.arrows },
      isDisabled: () => picture.viewer === null,
      isPressed: () => picture.arrowsVisible,
      perform: () => (picture.arrowsVisible = !picture.arrowsVisible),
    },
  ];
}

/** Actions that have a key and no button. */
export function keyActions(picture: Picture): Action[] {
  return [
    {
      ...{ name: 'grid', label: t('Show or hide the grid'), key: 'G' },
      perform: () => picture.viewer?.toggleGrid(),
    },
    {
      name: 'parallel',
      label: t('Switch between parallel and perspective view'),
      key: 'O',
      perform: () => {
        const { viewer } = picture;
        if (viewer) viewer.parallel = !viewer.rig.parallel;
      },
    },
    {
      ...{ name: 'unfollow', label: t('Stop following'), key: 'Escape' },
      perform: () => picture.follow(null),
    },
  ];
}

/** The keys that move the camera. */
export function cameraKeys(picture: Picture): CameraKeys {
  const rig = () => picture.viewer?.rig;
  return {
    preset: (preset) => rig()?.preset(preset, performance.now()),
    orbit: (around, up) => rig()?.orbit(around, up),
    pan: (right, up) => rig()?.pan(right, up),
    zoom: (factor) => rig()?.zoom(factor),
  };
}
