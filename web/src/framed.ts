/** The page within another page, such as a report: it offers full screen, and the wheel scrolls the outer page. */
import { byId } from './dom';

export function settleInFrame(): void {
  if (window.parent === window) return;
  // The wheel zooms only after the user has entered the frame by a click or by the keyboard.
  const pass = (event: Event) => document.hasFocus() || event.stopImmediatePropagation();
  window.addEventListener('wheel', pass, { capture: true, passive: true });

  const button = byId<HTMLButtonElement>('fullscreen');
  button.hidden = !document.fullscreenEnabled;
  button.addEventListener('click', () => {
    void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
  });
  document.addEventListener('fullscreenchange', () => {
    button.title = document.fullscreenElement ? 'Leave full screen' : 'Fill the screen';
    button.setAttribute('aria-label', button.title);
  });
}
