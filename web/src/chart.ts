/** Chart: curves drawn by uPlot, in the colours of the theme. */
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { Theme } from './theme';

export interface Curve {
  label: string;
  /** Colour by theme: "plot", "decided", or one of the categorical colours by number. */
  colour: 'plot' | 'decided' | 'ruler' | number;
  dash?: number[];
  points?: boolean;
}
export interface Axes {
  x: string;
  y: string;
  low?: number;
  high?: number;
}

/** By day, colours that colour-blind people can tell apart; at night, lightness and dash. */
const kMany = {
  day: ['#0072b2', '#d55e00', '#008060', '#a0428a', '#6b6b00', '#444444'],
  night: ['#f3b676', '#d8733a', '#a85a30', '#e8d08a', '#c05040', '#8a6a50'],
};
const kDashes = [[], [8, 3], [3, 3], [10, 3, 2, 3], [2, 2], [6, 6]];

export class Chart {
  private plot: uPlot | null = null;
  private look = '';
  private size = '';

  constructor(
    private readonly box: HTMLElement,
    private readonly theme: Theme,
  ) {}

  show(data: uPlot.AlignedData, curves: readonly Curve[], axes: Axes): void {
    const [width, height] = [this.box.clientWidth, this.box.clientHeight];
    if (width < 40 || height < 40) return;
    const look = `${this.theme.revision} ${JSON.stringify([curves, axes])}`;
    if (look !== this.look || !this.plot) {
      this.plot?.destroy();
      this.plot = new uPlot(this.options(curves, axes, width, height), data, this.box);
      this.look = look;
    } else {
      if (this.size !== `${width} ${height}`) this.plot.setSize({ width, height });
      this.plot.setData(data);
    }
    this.size = `${width} ${height}`;
  }

  clear(): void {
    this.plot?.destroy();
    this.plot = null;
  }

  private options(curves: readonly Curve[], axes: Axes, width: number, height: number): uPlot.Options {
    const { paint, name } = this.theme;
    const colourOf = (colour: Curve['colour']) =>
      typeof colour === 'number'
        ? kMany[name][colour % kMany[name].length]!
        : colour === 'decided'
          ? paint.obstacle
          : paint[colour];
    const axis = (label: string, size: number): uPlot.Axis => ({
      label,
      labelSize: 18,
      size,
      stroke: paint.ink,
      font: '11px system-ui, sans-serif',
      labelFont: '11px system-ui, sans-serif',
      grid: { stroke: paint.grid, width: 1 },
      ticks: { stroke: paint.grid, width: 1, size: 4 },
    });
    return {
      width,
      height,
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false },
        y:
          axes.low === undefined
            ? { range: (_, __, most) => [0, Math.max(1e-3, most * 1.1)] }
            : { range: [axes.low, axes.high ?? 1] },
      },
      axes: [axis(axes.x, 26), axis(axes.y, 40)],
      series: [
        {},
        ...curves.map(({ label, colour, dash, points }): uPlot.Series => ({
          label,
          stroke: colourOf(colour),
          width: points ? 0 : 1.5,
          dash: dash ?? (typeof colour === 'number' ? kDashes[colour % kDashes.length]! : []),
          points: points ? { show: true, size: 6, fill: colourOf(colour), stroke: colourOf(colour) } : { show: false },
          ...(points ? { paths: () => null } : {}),
        })),
      ],
    };
  }

  /** The colour of a numbered curve, for a legend beside it. */
  colour(number: number): string {
    return kMany[this.theme.name][number % kMany[this.theme.name].length]!;
  }
}
