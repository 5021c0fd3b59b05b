/** What the browser keeps of the user's choices. Without storage (a page from a file, say) they last as long as the page. */
export function kept(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}
export function keep(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Storage is not allowed here.
  }
}

export function keptObject(key: string): Record<string, unknown> {
  try {
    const object: unknown = JSON.parse(kept(key) ?? '{}');
    return typeof object === 'object' && object !== null ? { ...object } : {};
  } catch {
    return {};
  }
}

/** Boxes and lists of choices as the user left them, by their ids. Call `keep` after a change by the page. */
export class KeptChoices {
  constructor(
    private readonly key: string,
    readonly inputs: readonly (HTMLInputElement | HTMLSelectElement)[],
  ) {
    const object = keptObject(key);
    for (const input of inputs) {
      const value = object[input.id];
      if (input instanceof HTMLInputElement) {
        if (typeof value === 'boolean') input.checked = value;
      } else if ([...input.options].some((option) => option.value === value)) {
        input.value = value as string;
      }
      input.addEventListener('change', () => this.keep());
    }
  }

  keep(): void {
    const of = (input: HTMLInputElement | HTMLSelectElement) =>
      input instanceof HTMLInputElement ? input.checked : input.value;
    keep(this.key, JSON.stringify(Object.fromEntries(this.inputs.map((input) => [input.id, of(input)]))));
  }
}
