// SPDX-License-Identifier: Apache-2.0
// How like two pictures of a block are: structural similarity (Wang et al. 2004, "Image quality
// assessment: from error visibility to structural similarity"), and pixels of the wrong skin.

/**
 * Compares screenshots of one size in which the block has the material “Tooling board”: its skin is
 * blue, what is cut is nearly white.
 * @param page any page: it decodes the files
 * @param truth the picture as it should be
 * @param empty the same without the block
 * @returns `ssim`: the mean over windows of 8 × 8 pixels that show the block; `wrongSkin`: the share
 *   of the block's pixels whose color is rather that of the other skin
 */
export function likeness(page, picture, truth, empty) {
  const files = [picture, truth, empty].map((png) => png.toString('base64'));
  return page.evaluate(async (encoded) => {
    const WINDOW = 8;
    const [C1, C2] = [(0.01 * 255) ** 2, (0.03 * 255) ** 2];
    const HALF_WAY = 0.08; // between the blue parts of skin and cut surface, 0.18 and 0.02
    const decode = async (base64) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
      const { width, height } = bitmap;
      const context = new OffscreenCanvas(width, height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return {
        width,
        height,
        rgba: context.getImageData(0, 0, width, height).data,
      };
    };
    const [seen, should, without] = await Promise.all(encoded.map(decode));
    const { width, height } = should;
    const luma = ({ rgba }, p) => 0.299 * rgba[p] + 0.587 * rgba[p + 1] + 0.114 * rgba[p + 2];
    const blue = ({ rgba }, p) =>
      (rgba[p + 2] - rgba[p]) / Math.max(1, rgba[p] + rgba[p + 1] + rgba[p + 2]);
    const isBlock = (p) =>
      [0, 1, 2].some((c) => Math.abs(should.rgba[p + c] - without.rgba[p + c]) > 12);
    let [pixels, wrong, windows, sum] = [0, 0, 0, 0];
    for (let top = 0; top + WINDOW <= height; top += WINDOW) {
      for (let left = 0; left + WINDOW <= width; left += WINDOW) {
        let [n, shown, a, b, aa, bb, ab] = [0, 0, 0, 0, 0, 0, 0];
        for (let y = top; y < top + WINDOW; ++y) {
          for (let x = left; x < left + WINDOW; ++x) {
            const p = 4 * (y * width + x);
            const [u, v] = [luma(seen, p), luma(should, p)];
            n += 1;
            a += u;
            b += v;
            aa += u * u;
            bb += v * v;
            ab += u * v;
            if (!isBlock(p)) continue;
            shown += 1;
            if (Math.abs(blue(seen, p) - blue(should, p)) > HALF_WAY) wrong += 1;
          }
        }
        pixels += shown;
        if (shown === 0) continue;
        const [ma, mb] = [a / n, b / n];
        const [va, vb, cov] = [aa / n - ma * ma, bb / n - mb * mb, ab / n - ma * mb];
        sum += ((2 * ma * mb + C1) * (2 * cov + C2)) / ((ma * ma + mb * mb + C1) * (va + vb + C2));
        windows += 1;
      }
    }
    return { ssim: sum / windows, wrongSkin: wrong / pixels, pixels };
  }, files);
}
