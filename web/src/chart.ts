/** Chart: curves drawn by uPlot, in the colours of the theme. */
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { Theme } from './theme';
import { elapsed } from './units';

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
  /** A plot over the time of the run: its end and the shown moment, s. Such a plot fits its values. */
  end?: number;
  now?: number;
  /** Values grow downwards. */
  down?: boolean;
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
  private now: number | undefined;
  private end = 1;

  constructor(
    private readonly box: HTMLElement,
    private readonly theme: Theme,
    /** A press on the plot, with its time. */
    private readonly press?: (at: number) => void,
  ) {}

  show(data: uPlot.AlignedData, curves: readonly Curve[], axes: Axes): void {
    const [width, height] = [this.box.clientWidth, this.box.clientHeight];
    if (width < 40 || height < 40) return;
    this.now = axes.now;
    this.end = Math.max(1, axes.end ?? 0);
    const { now: _now, end: _end, ...steady } = axes;
    const look = `${this.theme.revision} ${JSON.stringify([curves, steady])}`;
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
    const timed = axes.end !== undefined;
    return {
      width,
      height,
      legend: { show: false },
      cursor: timed ? { y: false, drag: { x: false, y: false }, points: { show: false } } : { show: false },
      scales: {
        x: timed ? { time: false, range: () => [0, this.end] } : { time: false },
        y: timed ? { dir: axes.down ? -1 : 1 } : axes.low === undefined
            ? { range: (_, __, most) => [0, Math.max(1e-3, most * 1.1)] }
            : { range: [axes.low, axes.high ?? 1] },
      },
      axes: [timed ? { ...axis('', 22), labelSize: 0, values: (_, all) => all.map((s) => elapsed(s, 0)) } : axis(axes.x, 26), axis(axes.y, 40)],
      hooks: timed ? { draw: [(plot) => this.markNow(plot)], ready: [(plot) => this.listen(plot)] } : {},
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

  private markNow(plot: uPlot): void {
    if (this.now === undefined) return;
    const { ctx: pen, bbox } = plot;
    const x = plot.valToPos(this.now, 'x', true);
    pen.save();
    pen.strokeStyle = this.theme.paint.ink;
    pen.lineWidth = 1.5;
    pen.setLineDash([]);
    pen.beginPath();
    pen.moveTo(x, bbox.top);
    pen.lineTo(x, bbox.top + bbox.height);
    pen.stroke();
    pen.restore();
  }

  private listen(plot: uPlot): void {
    plot.over.addEventListener('click', ({ offsetX }) => this.press?.(Math.max(0, plot.posToVal(offsetX, 'x'))));
  }

  /** The colour of a numbered curve, for a legend beside it. */
  colour(number: number): string {
    return kMany[this.theme.name][number % kMany[this.theme.name].length]!;
  }
}
