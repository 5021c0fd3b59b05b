/**
 * Theme: day and night colours. The style sheet has the colours of the page, this file those of the canvases.
 * Night is dim and without blue, to keep eyes adapted to the dark. Whatever differs by hue by day also differs by
 * lightness, dash or shape, so that nothing is lost at night.
 */
import { depthTables, type Table, type TableName } from './colours';
import { keep, kept } from './kept';

export interface Paint {
  water: string;
  ink: string;
  faint: string;
  /** Behind text on the map. */
  halo: string;
  grid: string;
  land: string;
  shore: string;
  fence: string;
  mission: string;
  truth: string;
  obstacle: string;
  obstacleFill: string;
  behind: string;
  echo: readonly [number, number, number];
  way: string;
  oldWay: string;
  track: string;
  vehicle: string;
  vehicleEdge: string;
  decision: string;
  sound: string;
  ruler: string;
  hatch: string;
  occupied: readonly [number, number, number];
  free: readonly [number, number, number];
  decided: readonly [number, number, number];
  depth: Table;
  /** Five classes of the confidence 0..20. */
  confidence: readonly (readonly [number, number, number])[];
  intensity: TableName;
  sky: string;
  plot: string;
}

const day: Paint = {
  water: '#e8f1f8',
  ink: '#22242a',
  faint: '#5c6470',
  halo: 'rgb(255 255 255 / 0.85)',
  grid: 'rgb(40 60 80 / 0.16)',
  land: '#f5e6bd',
  shore: '#4d3d1f',
  fence: '#a61a73',
  mission: '#00805f',
  truth: '#3d3d3d',
  obstacle: '#b84a00',
  obstacleFill: 'rgb(214 94 0 / 0.30)',
  behind: '#575799',
  echo: [150, 40, 0],
  way: '#5a2ca0',
  oldWay: 'rgb(90 44 160 / 0.28)',
  track: '#0072b2',
  vehicle: '#ffd21f',
  vehicleEdge: '#14202c',
  decision: '#d65e00',
  sound: '#006b75',
  ruler: '#c00d1e',
  hatch: 'rgb(255 255 255 / 0.5)',
  occupied: [166, 58, 0],
  free: [255, 255, 255],
  decided: [255, 64, 150],
  depth: depthTables.day,
  confidence: [
    [179, 58, 17],
    [247, 148, 71],
    [253, 224, 144],
    [103, 169, 217],
    [8, 58, 130],
  ],
  intensity: 'cividis',
  sky: '#dfe9f1',
  plot: '#0072b2',
};

const night: Paint = {
  water: '#120907',
  ink: '#d99a78',
  faint: '#a8694e',
  halo: 'rgb(14 6 4 / 0.8)',
  grid: 'rgb(200 110 70 / 0.14)',
  land: '#2b1d0f',
  shore: '#7d5a30',
  fence: '#b3425c',
  mission: '#c9a24a',
  truth: '#9b8361',
  obstacle: '#ff5a30',
  obstacleFill: 'rgb(255 80 40 / 0.30)',
  behind: '#a06a58',
  echo: [255, 138, 84],
  way: '#f0b27a',
  oldWay: 'rgb(240 178 122 / 0.22)',
  track: '#b98a3c',
  vehicle: '#f2c14e',
  vehicleEdge: '#1a0b06',
  decision: '#c2491d',
  sound: '#d8b25a',
  ruler: '#ff7a5c',
  hatch: 'rgb(10 4 2 / 0.6)',
  occupied: [235, 84, 40],
  free: [112, 62, 44],
  decided: [255, 236, 170],
  depth: depthTables.night,
  confidence: [
    [96, 22, 12],
    [128, 44, 22],
    [156, 78, 34],
    [184, 118, 54],
    [214, 166, 92],
  ],
  intensity: 'ember',
  sky: '#0d0604',
  plot: '#e09050',
};

export type ThemeName = 'day' | 'night';
const kKey = 'isobath-theme';

export class Theme {
  name: ThemeName;
  revision = 0;
  private readonly prefersDark = matchMedia('(prefers-color-scheme: dark)');

  constructor(private readonly changed: () => void) {
    this.name = this.stored() ?? (this.prefersDark.matches ? 'night' : 'day');
    this.show();
    this.prefersDark.addEventListener('change', () => {
      if (!this.stored()) this.become(this.prefersDark.matches ? 'night' : 'day');
    });
  }

  get paint(): Paint {
    return this.name === 'day' ? day : night;
  }

  toggle(): void {
    this.become(this.name === 'day' ? 'night' : 'day');
    keep(kKey, this.name);
  }

  private stored(): ThemeName | undefined {
    const name = kept(kKey);
    return name === 'day' || name === 'night' ? name : undefined;
  }

  private become(name: ThemeName): void {
    this.name = name;
    this.show();
    this.changed();
  }

  private show(): void {
    ++this.revision;
    document.documentElement.dataset.theme = this.name;
    document.querySelector('meta[name="theme-color"]')?.setAttribute('content', this.paint.sky);
  }
}
