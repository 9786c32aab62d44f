// SPDX-License-Identifier: Apache-2.0
// Measures a page from outside of its code: pictures that it draws, tasks that block it, and the
// time from an input until the picture that shows it is painted. Without a GPU the page draws on a
// canvas that is not in the document, and puts the picture on one that is when it is ready.

/** The script that measures; it runs before the page's own. */
export const METER = `
  const meter = { pictures: [], tasks: [], inputs: [], presented: [], programs: [], waits: [] };
  window.meter = meter;
  const isPut = () => document.querySelector('.canvas').getContext('2d') !== null;
  let drawn = false;
  let waiting = [];
  for (const name of ['drawElements', 'drawElementsInstanced', 'drawArrays']) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...all) {
      drawn = true;
      return draw.apply(this, all);
    };
  }
  const answered = WebGL2RenderingContext.prototype.getProgramParameter;
  WebGL2RenderingContext.prototype.getProgramParameter = function (...all) {
    const begin = performance.now();
    const answer = answered.apply(this, all);
    meter.waits.push(performance.now() - begin);
    return answer;
  };
  const link = WebGL2RenderingContext.prototype.linkProgram;
  WebGL2RenderingContext.prototype.linkProgram = function (program) {
    meter.programs.push(performance.now());
    return link.call(this, program);
  };
  // A message is handled after the browser has painted the frame in which it was sent.
  const painted = new MessageChannel();
  painted.port1.onmessage = ({ data }) => {
    const now = performance.now();
    for (const at of data) meter.inputs.push(now - at);
  };
  let drawing = [];
  const put = CanvasRenderingContext2D.prototype.putImageData;
  CanvasRenderingContext2D.prototype.putImageData = function (...all) {
    if (this.canvas.matches('.canvas')) {
      const shown = drawing;
      drawing = [];
      request(() => painted.port2.postMessage(shown));
    }
    return put.apply(this, all);
  };
  const request = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (callback) =>
    request((now) => {
      drawn = false;
      callback(now);
      if (!drawn) return;
      meter.pictures.push(now);
      if (isPut()) drawing = waiting;
      else painted.port2.postMessage(waiting);
      waiting = [];
    });
  addEventListener('keydown', ({ timeStamp }) => waiting.push(timeStamp), { capture: true });
  new PerformanceObserver((list) => {
    for (const { startTime, duration } of list.getEntries())
      meter.tasks.push([startTime, duration]);
  }).observe({ type: 'longtask', buffered: true });
  new PerformanceObserver((list) => {
    for (const { name, duration } of list.getEntries())
      if (name === 'keydown') meter.presented.push(duration);
  }).observe({ type: 'event', durationThreshold: 16, buffered: true });
`;

/** Forgets what was measured so far. */
export function reset(page) {
  return page.evaluate(() => {
    for (const list of Object.values(window.meter)) list.length = 0;
  });
}

/**
 * The measurements since then: times of pictures, durations of tasks longer than 50 ms, times from a
 * key to the painted picture, and until it was presented (of those above 16 ms), ms; when shader
 * programs were linked.
 */
export async function read(page) {
  const { pictures, tasks, inputs, presented, programs, waits } = await page.evaluate(
    () => window.meter,
  );
  const gaps = pictures.slice(1).map((at, n) => at - pictures[n]);
  return {
    pictures,
    gaps,
    tasks: tasks.map(([, duration]) => duration),
    inputs,
    presented,
    programs,
    waits,
  };
}

/** The value below which a share of the values lie; 0 of none. */
export function percentile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}
