/** Movements of a camera about the target that it looks at, as keys and buttons ask for them. */
import { Vector3 } from 'three';

export function zoom(camera: Vector3, target: Vector3, factor: number): void {
  camera.sub(target).divideScalar(factor).add(target);
}

/** Turns the camera about its target in steps of about 6 degrees. */
export function turn(camera: Vector3, target: Vector3, right: number, up: number): void {
  const arm = camera.clone().sub(target);
  const level = Math.hypot(arm.x, arm.y);
  const azimuth = Math.atan2(arm.y, arm.x) + 0.1 * right;
  const elevation = Math.min(1.54, Math.max(-1.4, Math.atan2(arm.z, level) + 0.1 * up));
  const length = arm.length();
  arm.set(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation));
  camera.copy(target).addScaledVector(arm, length);
}

/** Moves camera and target level, in steps of 6 % of their distance. */
export function pan(camera: Vector3, target: Vector3, right: number, ahead: number): void {
  const arm = target.clone().sub(camera).setZ(0).normalize();
  const side = new Vector3(arm.y, -arm.x, 0);
  const step = camera.distanceTo(target) * 0.06;
  const by = arm.multiplyScalar(ahead * step).addScaledVector(side, right * step);
  target.add(by);
  camera.add(by);
}
