/** Gestures of mouse, pen and fingers on a view: one pointer drags, two pinch, the wheel zooms at the pointer. */
export interface Gestured {
  drag(dx: number, dy: number): void;
  zoom(factor: number, x: number, y: number): void;
  /** Position of the pointer; null: it has left. */
  hover(at: [number, number] | null): void;
  /** Pressed and released at a position. */
  tap?(x: number, y: number): void;
  /** True: this view handles the drag that begins here itself (a ruler); it gets `pull` until the drag ends. */
  grasp(x: number, y: number): boolean;
  pull(x: number, y: number): void;
  /** The pointers that were down are up. */
  release?(): void;
}

/** px: a finger may slip this far in a tap. */
const kSlip = 8;

export function listen(element: HTMLElement, view: Gestured): void {
  const down = new Map<number, [number, number]>();
  let pulling = false;
  /** Start position of a press that may become a tap. */
  let pressed: [number, number] | null = null;
  const at = (event: { clientX: number; clientY: number }): [number, number] => {
    const box = element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const spread = () => {
    const [a, b] = [...down.values()] as [[number, number], [number, number]];
    return { x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, far: Math.max(10, Math.hypot(a[0] - b[0], a[1] - b[1])) };
  };

  element.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    down.set(event.pointerId, at(event));
    pressed = down.size === 1 ? at(event) : null;
    pulling = down.size === 1 && view.grasp(...at(event));
    view.hover(at(event));
  });
  element.addEventListener('pointermove', (event) => {
    const before = down.get(event.pointerId);
    const now = at(event);
    if (!before) return view.hover(now);
    if (pressed && Math.hypot(now[0] - pressed[0], now[1] - pressed[1]) > kSlip) pressed = null;
    if (down.size === 1) {
      down.set(event.pointerId, now);
      view.hover(now);
      if (pulling) view.pull(...now);
      else view.drag(now[0] - before[0], now[1] - before[1]);
    } else if (down.size === 2) {
      const was = spread();
      down.set(event.pointerId, now);
      const is = spread();
      view.drag(is.x - was.x, is.y - was.y);
      view.zoom(is.far / was.far, is.x, is.y);
    }
  });
  for (const name of ['pointerup', 'pointercancel'] as const) {
    element.addEventListener(name, (event) => {
      down.delete(event.pointerId);
      pulling = false;
      view.release?.();
      if (pressed && name === 'pointerup') view.tap?.(...pressed);
      pressed = null;
    });
  }
  // A button that a tap shows under the finger does not get the click of the same tap.
  element.addEventListener('touchend', (event) => event.cancelable && event.preventDefault(), { passive: false });
  element.addEventListener('pointerleave', () => down.size === 0 && view.hover(null));
  element.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 16 : 1;
      view.zoom(Math.exp(-event.deltaY * lines * 0.0018), ...at(event));
    },
    { passive: false },
  );
}
