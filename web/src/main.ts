// SPDX-License-Identifier: Apache-2.0
import './model/marks';
import '@fontsource-variable/inter/wght.css';
import './ui/style/index.css';
import { joinEarly } from './link/early_socket';
import { language, loadTexts } from './strings';

// The code of the page runs when its texts are there: its constants have some of them.
async function main(): Promise<void> {
  document.documentElement.lang = language;
  await loadTexts();
  joinEarly();
  const { showPage } = await import('./shell/page');
  await showPage();
}

void main();
