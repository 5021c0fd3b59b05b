/**
 * The static layers: land, fence, keep-out areas, the ground truth of a simulation, and the mission points.
 */
import type { Scene } from '../items';
import { label, stroke, trace, type Pen } from './pen';

export function drawLand(pen: Pen, scene: Scene): void {
  for (const outline of [...scene.land, ...scene.charted]) {
    trace(pen, outline, true);
    pen.drawing.fillStyle = pen.paint.land;
    pen.drawing.fill();
    stroke(pen, { colour: pen.paint.shore, width: 1.5 });
  }
}

export function drawFences(pen: Pen, scene: Scene): void {
  const { paint, drawing } = pen;
  if (scene.fence.length > 2) {
    trace(pen, scene.fence, true);
    stroke(pen, { colour: paint.fence, width: 2, dash: [7, 5] });
  }
  for (const outline of scene.keepOut) {
    trace(pen, outline, true);
    drawing.save();
    drawing.globalAlpha = 0.14;
    drawing.fillStyle = paint.fence;
    drawing.fill();
    drawing.restore();
    stroke(pen, { colour: paint.fence, width: 1.5 });
    drawing.save();
    drawing.clip();
    crossOut(pen, outline);
    drawing.restore();
  }
}

/** Hatches a keep-out area, so that it is recognised without its colour. */
function crossOut(pen: Pen, outline: readonly (readonly [number, number])[]): void {
  const { camera, drawing, paint } = pen;
  const [xs, ys] = [outline.map((p) => camera.x(...p)), outline.map((p) => camera.y(...p))];
  const [left, right] = [Math.max(0, Math.min(...xs)), Math.min(camera.width, Math.max(...xs))];
  const [top, bottom] = [Math.max(0, Math.min(...ys)), Math.min(camera.height, Math.max(...ys))];
  drawing.beginPath();
  for (let x = Math.floor((left - (bottom - top)) / 12) * 12; x < right; x += 12) {
    drawing.moveTo(x, bottom);
    drawing.lineTo(x + (bottom - top), top);
  }
  drawing.globalAlpha = 0.5;
  stroke(pen, { colour: paint.fence, width: 1 });
}

export function drawBodies(pen: Pen, scene: Scene): void {
  const { camera, paint } = pen;
  const named = new Set<string>(); // a bank of many parts has one name
  for (const { name, outline } of scene.bodies) {
    if (outline.length < 2) continue;
    trace(pen, outline, true);
    stroke(pen, { colour: paint.truth, width: 1.5, dash: [3, 3] });
    const wide = spread(pen, outline);
    if (!name || named.has(name) || camera.scale > 0.5 || wide < 3) continue;
    const [north, east] = middle(outline);
    const [x, y] = [camera.x(north, east), camera.y(north, east) + wide / 2 + 10];
    const seen = x > 0 && x < camera.width && y > 0 && y < camera.height;
    if (seen && label(pen, name, x, y, paint.truth)) named.add(name);
  }
}

export function drawMission(pen: Pen, scene: Scene, target: number | undefined): void {
  const { camera, drawing, paint } = pen;
  if (scene.mission.length > 1) {
    drawing.beginPath();
    for (const { at, apart } of scene.mission) {
      const [x, y] = [camera.x(...at), camera.y(...at)];
      if (apart) drawing.moveTo(x, y);
      else drawing.lineTo(x, y);
    }
    stroke(pen, { colour: paint.mission, width: 1.2, dash: [2, 4] });
  }
  scene.mission.forEach(({ at }, i) => {
    const [x, y] = [camera.x(...at), camera.y(...at)];
    drawing.beginPath();
    drawing.arc(x, y, 9, 0, 2 * Math.PI);
    stroke(pen, { colour: paint.halo, width: 5 });
    drawing.beginPath();
    drawing.arc(x, y, 9, 0, 2 * Math.PI);
    stroke(pen, { colour: paint.mission, width: 2.2 });
    drawing.beginPath();
    drawing.arc(x, y, i === target ? 4.5 : 1.5, 0, 2 * Math.PI);
    drawing.fillStyle = paint.mission;
    drawing.fill();
  });
  const points = [...scene.mission.entries()];
  if (target !== undefined) points.unshift(...points.splice(target, 1)); // the target is always named
  for (const [i, { name, at }] of points) {
    label(pen, name || String(i + 1), camera.x(...at) + 14, camera.y(...at) - 10, paint.mission, 'left');
  }
}

export function middle(outline: readonly (readonly [number, number])[]): [number, number] {
  const sum = outline.reduce<[number, number]>((s, p) => [s[0] + p[0], s[1] + p[1]], [0, 0]);
  return [sum[0] / Math.max(1, outline.length), sum[1] / Math.max(1, outline.length)];
}
/** px */
export function spread({ camera }: Pen, outline: readonly (readonly [number, number])[]): number {
  const ys = outline.map((p) => camera.y(...p));
  return Math.max(...ys) - Math.min(...ys);
}
