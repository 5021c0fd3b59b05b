/**
 * The moving layers: routes, track, vehicle, and the selected decision.
 */
import type { Decision } from '../items';
import type { Model } from '../model';
import { partnerNote } from '../partners';
import { age } from '../units';
import { label, stroke, trace, type Pen } from './pen';

const kOldWays = 40;

export function drawOldWays(pen: Pen, model: Model): void {
  for (const { way } of model.decisions.slice(-kOldWays)) {
    if (way.length < 2) continue;
    trace(pen, way, false);
    stroke(pen, { colour: pen.paint.oldWay, width: 1.5, dash: [6, 4] });
  }
}

export function drawWay(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  const points = model.way?.points ?? [];
  if (points.length < 2) return;
  trace(pen, points, false);
  stroke(pen, { colour: paint.halo, width: 5 });
  trace(pen, points, false);
  stroke(pen, { colour: paint.way, width: 2.5 });
  drawing.fillStyle = paint.way;
  for (const [north, east] of points.slice(1)) {
    drawing.beginPath();
    drawing.arc(camera.x(north, east), camera.y(north, east), 3.5, 0, 2 * Math.PI);
    drawing.fill();
  }
}

export function drawTrack(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  if (model.track.size === 0) return;
  drawing.beginPath();
  // Pieces in the order of their numbers; a piece that is missing breaks the line.
  const numbers = [...model.track.keys()].sort((a, b) => a - b);
  let before = -2;
  for (const number of numbers) {
    const { places } = model.track.get(number)!;
    for (let i = 0; i + 3 < places.length; i += 4) {
      const [x, y] = [camera.x(places[i + 1]!, places[i + 2]!), camera.y(places[i + 1]!, places[i + 2]!)];
      if (i === 0 && number !== before + 1) drawing.moveTo(x, y);
      else drawing.lineTo(x, y);
    }
    before = number;
  }
  const { vehicle } = model;
  if (vehicle) drawing.lineTo(camera.x(vehicle.north, vehicle.east), camera.y(vehicle.north, vehicle.east));
  drawing.lineJoin = 'round';
  stroke(pen, { colour: paint.halo, width: 4.5 });
  stroke(pen, { colour: paint.track, width: 2.2 });
}

export function drawPartners(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  const size = 7;
  for (const [vehicle, partner] of model.partners) {
    const [x, y] = [camera.x(...partner.at), camera.y(...partner.at)];
    drawing.beginPath();
    for (const [dx, dy] of [
      [0, -size],
      [size, 0],
      [0, size],
      [-size, 0],
    ] as const)
      drawing.lineTo(x + dx, y + dy);
    drawing.closePath();
    drawing.fillStyle = paint.halo;
    drawing.fill();
    stroke(pen, { colour: paint.vehicle, width: 2 });
    const name = model.scene?.group[vehicle] ?? `vehicle ${vehicle + 1}`;
    const seconds = model.age(partner.heard);
    const ago = Number.isFinite(seconds) ? age(Math.max(0, seconds)) : '';
    label(pen, partnerNote(name, partner, ago), x + size + 4, y, paint.ink, 'left');
  }
}

export function drawVehicle(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  const { vehicle, scene } = model;
  if (!vehicle) return;
  const [x, y] = [camera.x(vehicle.north, vehicle.east), camera.y(vehicle.north, vehicle.east)];
  const length = (scene?.vehicle.length ?? 1.5) / camera.scale;
  if (vehicle.sigma > 0) {
    drawing.beginPath();
    drawing.arc(x, y, (2 * vehicle.sigma) / camera.scale, 0, 2 * Math.PI);
    stroke(pen, { colour: paint.track, width: 1, dash: [2, 3] });
  }
  const safe = scene?.vehicle.safe;
  if (safe) {
    drawing.beginPath();
    drawing.arc(x, y, safe / camera.scale, 0, 2 * Math.PI);
    stroke(pen, { colour: paint.faint, width: 1, dash: [6, 4] });
  }
  drawing.save();
  drawing.translate(x, y);
  drawing.rotate(vehicle.heading - camera.turn);
  courseAndWish(pen, model);
  hull(drawing, length);
  drawing.fillStyle = paint.vehicle;
  drawing.fill();
  stroke(pen, { colour: paint.vehicleEdge, width: 1.5 });
  drawing.restore();
}

/** In the vehicle's frame, bow up: its course over ground for the next 10 s, and its heading set-point. */
function courseAndWish(pen: Pen, model: Model): void {
  const { camera, drawing, paint } = pen;
  const { surge, sway, heading, wantedHeading } = model.vehicle!;
  const speed = Math.hypot(surge, sway);
  if (speed > 0.05) {
    const reach = Math.max(22, (speed * 10) / camera.scale);
    drawing.beginPath();
    drawing.moveTo(0, 0);
    drawing.lineTo((sway / speed) * reach, (-surge / speed) * reach);
    stroke(pen, { colour: paint.track, width: 2 });
  }
  if (Number.isFinite(wantedHeading)) {
    drawing.save();
    drawing.rotate(wantedHeading - heading);
    drawing.beginPath();
    drawing.moveTo(0, -30);
    drawing.lineTo(-4, -38);
    drawing.lineTo(4, -38);
    drawing.closePath();
    drawing.fillStyle = paint.way;
    drawing.fill();
    drawing.restore();
  }
}

/** The hull to scale; if that is less than 20 pixels, an arrow. */
function hull(drawing: CanvasRenderingContext2D, length: number): void {
  drawing.beginPath();
  if (length < 20) {
    for (const [x, y] of [
      [0, -13],
      [8, 9],
      [0, 5],
      [-8, 9],
    ] as const)
      drawing.lineTo(x, y);
  } else {
    const [half, wide] = [length / 2, length * 0.09];
    drawing.moveTo(0, -half);
    drawing.quadraticCurveTo(wide * 1.2, -half, wide, -half * 0.72);
    drawing.lineTo(wide, half * 0.45);
    drawing.lineTo(wide * 2.2, half * 0.82);
    drawing.lineTo(wide * 2.2, half * 0.95);
    drawing.lineTo(0, half);
    drawing.lineTo(-wide * 2.2, half * 0.95);
    drawing.lineTo(-wide * 2.2, half * 0.82);
    drawing.lineTo(-wide, half * 0.45);
    drawing.lineTo(-wide, -half * 0.72);
    drawing.quadraticCurveTo(-wide * 1.2, -half, 0, -half);
  }
  drawing.closePath();
}

export function drawDecision(pen: Pen, decision: Decision): void {
  const { camera, drawing, paint } = pen;
  if (decision.way.length > 1) {
    trace(pen, decision.way, false);
    stroke(pen, { colour: paint.halo, width: 6 });
    trace(pen, decision.way, false);
    stroke(pen, { colour: paint.decision, width: 2.5, dash: [9, 4] });
  }
  const at = decision.obstacle ?? decision.way[0];
  if (!at) return;
  const [x, y] = [camera.x(...at), camera.y(...at)];
  drawing.beginPath();
  drawing.moveTo(x, y);
  drawing.lineTo(x - 9, y - 20);
  drawing.arc(x, y - 24, 12, Math.PI * 0.75, Math.PI * 0.25);
  drawing.closePath();
  drawing.fillStyle = paint.decision;
  drawing.fill();
  stroke(pen, { colour: paint.halo, width: 2 });
  drawing.fillStyle = '#fff';
  drawing.font = 'bold 11px system-ui, sans-serif';
  drawing.textAlign = 'center';
  drawing.textBaseline = 'middle';
  drawing.fillText(String(decision.number), x, y - 24);
}
