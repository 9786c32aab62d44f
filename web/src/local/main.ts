// SPDX-License-Identifier: Apache-2.0
// kerf.html: the page that needs no server.

import '../model/marks';
import '@fontsource-variable/inter/wght.css';
import '../ui/style/index.css';
import './local.css';
import { installLocalHook } from './hook';
import { worksOffline } from './offline';
import { language, loadTexts } from '../strings';

const KEEPS_AFTER_MS = 3000;

// The code of the page runs when its texts are there: its constants have some of them.
async function main(): Promise<void> {
  document.documentElement.lang = language;
  await loadTexts();
  const { LocalPage } = await import('./local_page');
  const page = new LocalPage(document.getElementById('app')!);
  installLocalHook(page);
  page.start();
  // Starts late, so that it does not delay the files that the page itself loads.
  setTimeout(() => void worksOffline(), KEEPS_AFTER_MS);
}

void main();
