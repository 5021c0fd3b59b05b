/**
 * Colour tables of 256 entries, each packed as a little-endian RGBA word, ready for image data. The lightness of each
 * table grows evenly, so that colour-blind readers and grey prints lose nothing.
 */
export type Table = Uint32Array;
type Rgb = readonly [number, number, number];

export const packed = ([r, g, b]: Rgb, alpha = 255): number => ((alpha << 24) | (b << 16) | (g << 8) | r) >>> 0;
export const css = ([r, g, b]: Rgb, alpha = 1): string => `rgb(${r} ${g} ${b} / ${alpha})`;
export const rgbOf = (word: number): Rgb => [word & 255, (word >> 8) & 255, (word >> 16) & 255];

function hex(text: string): Rgb {
  const value = parseInt(text.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

/** Linear interpolation between evenly spaced stops. */
function between(...stops: string[]): Table {
  const colours = stops.map(hex);
  return Uint32Array.from({ length: 256 }, (_, i) => {
    const at = (i / 255) * (colours.length - 1);
    const k = Math.min(colours.length - 2, Math.floor(at));
    const [a, b] = [colours[k]!, colours[k + 1]!];
    return packed([0, 1, 2].map((c) => Math.round(a[c]! + (at - k) * (b[c]! - a[c]!))) as unknown as Rgb);
  });
}

/** Converts OKLCH (perceptual lightness, chroma and hue) to the sRGB of a screen. */
function oklch(lightness: number, chroma: number, hue: number): Rgb {
  const [a, b] = [chroma * Math.cos(hue), chroma * Math.sin(hue)];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const byte = (v: number) => {
    const u = Math.min(1, Math.max(0, v));
    return Math.round(255 * (u <= 0.0031308 ? 12.92 * u : 1.055 * u ** (1 / 2.4) - 0.055));
  };
  return [
    byte(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    byte(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    byte(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

/** Depth colours of the printed charts: shallow is pale cyan, deep is dark blue. */
const chart = Uint32Array.from({ length: 256 }, (_, i) => {
  const s = i / 255;
  const hue = ((212 + 46 * s) * Math.PI) / 180;
  return packed(oklch(0.955 - 0.645 * s, 0.03 + 0.36 * s * (1 - s) * 0.75 + 0.055 * s, hue));
});
/** Depth colours for eyes that are adapted to the dark: shallow stands out. */
const embers = Uint32Array.from({ length: 256 }, (_, i) => {
  const s = i / 255;
  return packed(oklch(0.5 - 0.29 * s, 0.08 - 0.04 * s, ((48 - 20 * s) * Math.PI) / 180));
});

export const tables = {
  cividis: between('#00204d', '#1d3a6c', '#4b546c', '#70737a', '#958f78', '#beb06b', '#e6d557', '#ffea46'),
  viridis: between('#440154', '#46327e', '#365c8d', '#277f8e', '#1fa187', '#4ac16d', '#a0da39', '#fde725'),
  grey: between('#000000', '#ffffff'),
  ember: between('#050101', '#380c05', '#75200c', '#b0401a', '#dc7434', '#f3b676'),
} as const;
export type TableName = keyof typeof tables;
export const depthTables = { day: chart, night: embers } as const;
