// SPDX-License-Identifier: Apache-2.0
// Drops files on a page, as a hand does.

/** `files`: contents by name, each a text or a Buffer. */
export function dropFiles(page, files) {
  const coded = Object.entries(files).map(([name, contents]) => [
    name,
    Buffer.from(contents).toString('base64'),
  ]);
  return page.evaluate((all) => {
    const dataTransfer = new DataTransfer();
    for (const [name, base64] of all) {
      const bytes = Uint8Array.from(atob(base64), (c) => c.codePointAt(0));
      dataTransfer.items.add(new File([bytes], name));
    }
    const event = new DragEvent('drop', {
      dataTransfer,
      bubbles: true,
      cancelable: true,
    });
    document.querySelector('main').dispatchEvent(event);
  }, coded);
}
