/**
 * Viewpoint: the camera of the 3-D view. Mouse, fingers and keys move it; it follows the vehicle, turns with it, and looks
 * at everything, or from above.
 */
import { PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { at, type Extent } from './frame';

/** Sine of the elevation from which on the camera looks from above. */
const kAbove = 0.98;

export class Viewpoint {
  readonly camera = new PerspectiveCamera(45, 1, 0.1, 20000);
  /** Whether it has looked at something yet. */
  placed = false;
  private controls: OrbitControls | null = null;
  /** It moves by itself, not because of the user. */
  private itself = false;
  /** Target of the camera while it follows the vehicle. */
  private followed: Vector3 | null = null;
  /** The heading that the camera has turned to, while it turns with the vehicle; rad. */
  private turned: number | null = null;

  constructor(
    private readonly follow: HTMLInputElement,
    private readonly course: HTMLInputElement,
    /** Called when it has ended following by itself. */
    private readonly stayed: () => void,
  ) {
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-60, -90, 70);
  }

  /** `changed` is called when the user has moved the camera. */
  start(canvas: HTMLCanvasElement, changed: () => void): void {
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI * 0.92;
    this.controls.addEventListener('change', () => {
      if (!this.itself) changed();
    });
  }

  moveBy(by: (camera: Vector3, target: Vector3) => void): void {
    if (!this.controls) return;
    by(this.camera.position, this.controls.target);
    this.controls.update();
  }

  /** Looks at the extent from the south-west, or at the vehicle that it follows. */
  lookAt(extent: Extent, vehicle: Vector3 | null): void {
    const wide = Math.max(20, extent.high[0]! - extent.low[0]!, extent.high[1]! - extent.low[1]!);
    const [n, e] = [0, 1].map((k) => (extent.low[k]! + extent.high[k]!) / 2) as [number, number];
    const follows = this.follow.checked && vehicle !== null;
    const far = follows ? Math.min(wide, 70) : (0.61 * wide) / Math.sin(this.half);
    this.look(follows ? vehicle : at(n, e, 0), new Vector3(-0.4, -0.75, 0.62), far);
    this.camera.far = wide * 20;
  }

  /** Looks down on a circle; north is up, or the bow while the camera turns with the vehicle. */
  lookDown(centre: Vector3, radius: number): void {
    this.look(centre, new Vector3(0, -1e-3, 1), radius / Math.tan(this.half));
    this.turned = null;
  }

  private look(target: Vector3, from: Vector3, far: number): void {
    this.placed = true;
    this.followed = null;
    this.controls!.target.copy(target);
    this.camera.position.copy(target).addScaledVector(from.normalize(), far);
    this.update();
  }

  /** Half the angle that the view spans across its shorter side, rad. */
  private get half(): number {
    const half = (this.camera.fov / 2) * (Math.PI / 180);
    return Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
  }

  /** Radius of the circle about a place that the view has room for, m. */
  room(place: Vector3): number {
    return this.camera.position.distanceTo(place) * Math.tan(this.half);
  }

  /** Follows the vehicle, and turns with it, where this is wanted. */
  goWith(vehicle: Vector3, heading: number): void {
    const { target } = this.controls!;
    // Dragging the view away ends following.
    if (this.followed && target.distanceTo(this.followed) > 1e-3) this.stay();
    this.followed = null;
    if (this.follow.checked) {
      this.camera.position.add(vehicle).sub(target);
      target.copy(vehicle);
      this.update();
      this.followed = vehicle;
    }
    this.turnWith(heading);
    this.controls!.zoomToCursor = !this.follow.checked;
  }

  /** Follows no longer. */
  stay(): void {
    if (!this.follow.checked) return;
    this.follow.checked = false;
    this.stayed();
  }

  /** With the course up the camera looks ahead from astern at first, and then turns about its target as the vehicle does. */
  private turnWith(heading: number): void {
    const arm = this.camera.position.clone().sub(this.controls!.target);
    const azimuth = Math.atan2(arm.y, arm.x); // from east towards north
    const behind = (bearing: number) => -Math.PI / 2 - bearing - azimuth;
    let by = 0;
    if (this.course.checked) by = this.turned === null ? behind(heading) : this.turned - heading;
    else if (this.turned !== null && this.above) by = behind(0);
    this.turned = this.course.checked ? heading : null;
    if (by === 0) return;
    this.camera.position.copy(this.controls!.target).add(arm.applyAxisAngle(this.camera.up, by));
    this.update();
  }

  /** Where it looks: the bearing of its upper edge or, lower down, of its middle, and the angle below the horizon, rad. */
  get looks(): { bearing: number; down: number } {
    const arm = this.camera.position.clone().sub(this.controls!.target);
    return { bearing: Math.atan2(-arm.x, -arm.y), down: Math.atan2(arm.z, Math.hypot(arm.x, arm.y)) };
  }

  get above(): boolean {
    if (!this.controls) return false;
    const arm = this.camera.position.clone().sub(this.controls.target);
    return arm.z > kAbove * arm.length();
  }

  private update(): void {
    this.itself = true;
    this.controls!.update();
    this.itself = false;
  }
}
