// SPDX-License-Identifier: Apache-2.0
// kerf.html: the page that needs no server.

import '../marks';
import '@fontsource-variable/inter/wght.css';
import '../ui/style/index.css';
import './local.css';
import { language, loadTexts } from '../strings';

// The code of the page runs when its texts are there: its constants have some of them.
async function main(): Promise<void> {
  document.documentElement.lang = language;
  await loadTexts();
  const { LocalPage } = await import('./local_page');
  new LocalPage(document.getElementById('app')!).start();
}

void main();
