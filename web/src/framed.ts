/** Inside another page, such as a report: it may fill the screen, and a wheel that only passes scrolls that other page. */
import { byId } from './dom';

export function settleInFrame(): void {
  if (window.parent === window) return;
  // Zoom is for who has come in by a click or by the keyboard.
  const pass = (event: Event) => document.hasFocus() || event.stopImmediatePropagation();
  window.addEventListener('wheel', pass, { capture: true, passive: true });

  const button = byId<HTMLButtonElement>('fullscreen');
  button.hidden = !document.fullscreenEnabled;
  button.addEventListener('click', () => {
    void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
  });
  document.addEventListener('fullscreenchange', () => {
    button.title = document.fullscreenElement ? 'Back to the page around' : 'Fill the screen';
    button.setAttribute('aria-label', button.title);
  });
}
