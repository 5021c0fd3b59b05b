/** Finds elements by id and makes new ones. Texts from outside are set as text only, never as markup. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

type Attributes = Record<string, string | number | boolean | undefined>;

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...inside: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...inside);
  return element;
}

/** Sets the text only if it differs, because setting a text makes the browser lay out again. */
export function say(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
export function mark(element: HTMLElement, name: string, value: string): void {
  if (element.dataset[name] !== value) element.dataset[name] = value;
}

/**
 * Makes `rows` the children of the list, in their order, and returns true. A row that is already in its place is not
 * touched, so that the focus outlasts it. While a pointer presses the list, its rows stay where they are, so that the
 * press ends on the row on which it began; then it returns false.
 */
export function arrange(list: HTMLElement, rows: readonly HTMLElement[]): boolean {
  if (list.matches(':active')) return false;
  const wanted = new Set<Element>(rows);
  const focused = document.activeElement;
  for (const child of [...list.children]) if (!wanted.has(child)) child.remove();
  rows.forEach((row, at) => {
    if (list.children[at] !== row) list.insertBefore(row, list.children[at] ?? null);
  });
  if (focused instanceof HTMLElement && list.contains(focused)) focused.focus();
  return true;
}

/** Fits a canvas to its box in screen pixels. Returns whether its size changed. */
export function fit(canvas: HTMLCanvasElement): boolean {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width === width && canvas.height === height) return false;
  canvas.width = width;
  canvas.height = height;
  return true;
}
export const pixelRatio = (): number => Math.min(2, window.devicePixelRatio || 1);

export function context(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  const drawing = canvas.getContext('2d');
  if (!drawing) throw new Error('this browser draws no 2-D canvas');
  return drawing;
}

/** A canvas that is not shown. */
export function sheet(width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  return canvas;
}
