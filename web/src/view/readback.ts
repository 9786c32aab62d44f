// SPDX-License-Identifier: Apache-2.0
// Shows the picture that the CPU draws with WebGL on another canvas. A browser without a GPU reads
// each picture back to put the page together, and stops the page until all of it is drawn: keys,
// pointers and tiles wait. Here the page asks for the pixels, goes on, and shows them when they are
// there. The canvas that WebGL draws on is not in the document, so the browser does not read it.

const POLL_MS = 4;

/** Puts rows of pixels, the lowest first, into an image, whose colors are not multiplied by alpha. */
export function copyUpright(rows: Uint8Array, width: number, image: Uint8ClampedArray): void {
  const stride = 4 * width;
  for (let to = 0; to < image.length; to += stride) {
    const from = image.length - stride - to;
    image.set(rows.subarray(from, from + stride), to);
  }
  for (let at = 3; at < image.length; at += 4) {
    const alpha = image[at]!;
    if (alpha === 255 || alpha === 0) continue;
    for (let n = at - 3; n < at; n += 1) image[n] = (image[n]! * 255) / alpha;
  }
}

export class Readback {
  private readonly screen_: CanvasRenderingContext2D;
  private isBusy_ = false;
  private shown_: Promise<void> = Promise.resolve();

  /**
   * @param gl of a canvas that is not in the document
   * @param screen the canvas that shows the pictures
   */
  constructor(
    private readonly gl: WebGL2RenderingContext,
    screen: HTMLCanvasElement,
  ) {
    this.screen_ = screen.getContext('2d')!;
    for (const name of ['webglcontextlost', 'webglcontextrestored'])
      gl.canvas.addEventListener(name, (event) => {
        event.preventDefault();
        screen.dispatchEvent(new Event(name));
      });
  }

  /** The last picture is still being drawn; the next one has to wait for it. */
  get isBusy(): boolean {
    return this.isBusy_;
  }

  /** Resolves once the last picture is shown, or has failed. */
  get shown(): Promise<void> {
    return this.shown_;
  }

  /** Shows the picture that has just been drawn as soon as it is there, and then calls `placed`. */
  show(placed: () => void): void {
    this.shown_ = this.show_(placed).catch((problem: unknown) => console.error(problem));
  }

  private async show_(placed: () => void): Promise<void> {
    const { gl } = this;
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const rows = new Uint8Array(4 * width * height);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, rows.length, gl.STREAM_READ);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    this.isBusy_ = true;
    await this.drawn_();
    this.isBusy_ = false;
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, buffer);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, rows);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    gl.deleteBuffer(buffer);
    if (gl.isContextLost()) return;
    this.put_(rows, width, height);
    placed();
  }

  /** Resolves when all that was asked of WebGL so far is done, or its context is lost. */
  private async drawn_(): Promise<void> {
    const { gl } = this;
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    while (fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED)
      await new Promise((resolve) => setTimeout(resolve, POLL_MS));
    gl.deleteSync(fence);
  }

  private put_(rows: Uint8Array, width: number, height: number): void {
    const { canvas } = this.screen_;
    if (canvas.width !== width || canvas.height !== height)
      Object.assign(canvas, { width, height });
    const image = new ImageData(width, height);
    copyUpright(rows, width, image.data);
    this.screen_.putImageData(image, 0, 0);
  }
}
