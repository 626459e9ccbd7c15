// Draws the record on a canvas of its own. Ten dense traces as paths, which is what plotting libraries
// make of them, take a browser without a graphics processor several times as long as their pixels.
import { unitText } from "../format";
import { t } from "../language";
import { themeColour } from "../theme";
import { columnBounds, envelopeOf, makeEnvelope, type Envelope } from "./core/decimation";
import { pixelOf } from "./core/raster";
import { tickText, ticks, timeText } from "./core/numbers";
import type { ChannelSetup } from "./core/setup";
import { type Range, fitted } from "./core/view";
import type { Oscilloscope } from "./oscilloscope";
import { TraceLayer } from "./trace_layer";

export interface Box {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

/// One scale with the channels on it.
export interface Scale {
  readonly key: string;
  readonly label: string;
  readonly range: Range;
  readonly box: Box;
  /// Where its numbers stand.
  readonly gutter: Box;
  readonly channels: readonly number[];
}

export interface Colours {
  readonly series: readonly string[];
  readonly text: string;
  readonly soft: string;
  readonly grid: string;
  readonly border: string;
  readonly surface: string;
  readonly accent: string;
  readonly bad: string;
}

const kSeries = 8;
const kGutter = 64;
const kBottom = 22;
const kTop = 18;
const kLaneGap = 8;

export function readColours(): Colours {
  return {
    series: Array.from({ length: kSeries }, (_, i) => themeColour(`--series-${i + 1}`)),
    text: themeColour("--text"),
    soft: themeColour("--text-soft"),
    grid: themeColour("--grid-line"),
    border: themeColour("--border-strong"),
    surface: themeColour("--surface"),
    accent: themeColour("--accent"),
    bad: themeColour("--bad"),
  };
}

export function seriesColour(index: number): string {
  return `var(--series-${(index % kSeries) + 1})`;
}

export class Picture {
  /// Of the last drawing, for whoever takes the mouse.
  scales: readonly Scale[] = [];
  shown: Range = { from: 0, to: 1 };
  plot: Box = { left: kGutter, top: kTop, right: kGutter + 1, bottom: kTop + 1 };
  colours: Colours;
  private readonly ranges = new Map<string, Range>();
  private envelope: Envelope = makeEnvelope(0);
  private readonly layer = new TraceLayer();
  private ratio = 1;
  private readonly context: CanvasRenderingContext2D;
  private readonly extremes = { low: 0, high: 0 };

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly scope: Oscilloscope,
  ) {
    this.context = canvas.getContext("2d", { alpha: false })!;
    this.colours = readColours();
  }

  // Between pixels and what they mean

  timeAt(x: number): number {
    const { left, right } = this.plot;
    return this.shown.from + ((x - left) / (right - left)) * (this.shown.to - this.shown.from);
  }
  xOf(time: number): number {
    const { left, right } = this.plot;
    return left + ((time - this.shown.from) / (this.shown.to - this.shown.from)) * (right - left);
  }
  levelAt(scale: Scale, y: number): number {
    const { range, box } = scale;
    return range.from + ((box.bottom - y) / (box.bottom - box.top)) * (range.to - range.from);
  }
  yOf(scale: Scale, level: number): number {
    const { range, box } = scale;
    return box.bottom - ((level - range.from) / (range.to - range.from)) * (box.bottom - box.top);
  }
  /// The scale whose numbers or whose lane is there.
  scaleAt(x: number, y: number): Scale | null {
    const inside = (box: Box) => x >= box.left && x < box.right && y >= box.top && y < box.bottom;
    return this.scales.find(({ gutter }) => inside(gutter)) ?? this.scales.find(({ box }) => inside(box)) ?? null;
  }

  draw(): void {
    const { context, canvas, colours } = this;
    const ratio = window.devicePixelRatio || 1;
    this.ratio = ratio;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (width < kGutter * 2 || height < kTop + kBottom + 20) {
      return;
    }
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colours.surface;
    context.fillRect(0, 0, width, height);
    context.font = `11px ${getComputedStyle(canvas).fontFamily}`;
    this.shown = this.scope.shown();
    this.layOut(width, height);
    this.drawGrid();
    this.drawGaps();
    const columns = Math.max(1, Math.round((this.plot.right - this.plot.left) * ratio));
    const bounds = columnBounds(this.scope.record.ring, this.shown.from, this.shown.to, columns);
    const dense = bounds[columns]! - bounds[0]! > columns;
    if (dense) {
      this.drawEnvelopes(bounds);
    }
    for (const scale of this.scales) {
      context.save();
      context.beginPath();
      context.rect(scale.box.left, scale.box.top, scale.box.right - scale.box.left, scale.box.bottom - scale.box.top);
      context.clip();
      for (const channel of dense ? [] : scale.channels) {
        const { slope, zero } = this.placed(scale, channel);
        context.strokeStyle = this.colour(channel);
        context.fillStyle = this.colour(channel);
        this.drawSamples(channel, bounds[0]!, bounds[columns]!, slope, zero);
      }
      context.restore();
    }
    this.drawTrigger();
    this.drawEvents();
    this.drawCursors();
  }

  private layOut(width: number, height: number): void {
    const { channels, layout } = this.scope.setup;
    const groups = new Map<string, number[]>();
    channels.forEach((channel, i) => {
      if (channel.visible) {
        const key = this.scope.axisKey(channel);
        groups.set(key, [...(groups.get(key) ?? []), i]);
      }
    });
    const lanes = layout === "lanes" || groups.size <= 1;
    const left = kGutter * (lanes ? 1 : Math.max(1, groups.size));
    this.plot = { left, top: kTop, right: width - 10, bottom: height - kBottom };
    const laneHeight = (this.plot.bottom - this.plot.top - kLaneGap * (groups.size - 1)) / Math.max(1, groups.size);
    this.scales = [...groups].map(([key, members], i) => {
      const top = lanes ? this.plot.top + i * (laneHeight + kLaneGap) : this.plot.top;
      const box = { left, top, right: this.plot.right, bottom: lanes ? top + laneHeight : this.plot.bottom };
      const gutterLeft = lanes ? 0 : i * kGutter;
      return {
        key,
        label: unitText(this.scope.display(channels[members[0]!]!).unit) || (key.startsWith("=") ? "" : "1"),
        range: this.rangeOf(key, members, channels),
        box,
        gutter: { left: gutterLeft, top, right: gutterLeft + kGutter, bottom: box.bottom },
        channels: members,
      };
    });
  }

  private rangeOf(key: string, members: readonly number[], channels: readonly ChannelSetup[]): Range {
    const fixed = this.scope.axis(key).range;
    if (fixed !== null) {
      this.ranges.set(key, fixed);
      return fixed;
    }
    const { ring } = this.scope.record;
    const from = Math.max(ring.first, ring.lowerBound(this.shown.from) - 1);
    const to = Math.min(ring.end, ring.lowerBound(this.shown.to) + 1);
    let low = Infinity;
    let high = -Infinity;
    for (const member of members) {
      const { slope, zero } = this.line(channels[member]!);
      ring.extremes(member, from, to, this.extremes);
      if (this.extremes.low <= this.extremes.high) {
        low = Math.min(low, this.extremes.low * slope + zero, this.extremes.high * slope + zero);
        high = Math.max(high, this.extremes.low * slope + zero, this.extremes.high * slope + zero);
      }
    }
    const range = fitted(low, high, this.ranges.get(key) ?? null);
    this.ranges.set(key, range);
    return range;
  }

  private drawGrid(): void {
    const { context, colours, plot, shown } = this;
    const kTickWidth = 110;
    const time = ticks(shown.from * 1e-9, shown.to * 1e-9, (plot.right - plot.left) / kTickWidth);
    context.lineWidth = 1;
    context.textBaseline = "top";
    context.textAlign = "center";
    const span = timeText((shown.to - shown.from) * 1e-9, 4);
    for (const at of time.at) {
      const x = Math.round(this.xOf(at * 1e9)) + 0.5;
      context.strokeStyle = colours.grid;
      for (const { box } of this.scales) {
        line(context, x, box.top, x, box.bottom);
      }
      context.fillStyle = colours.soft;
      context.fillText(tickText(at, time.step), x, plot.bottom + 5);
    }
    context.textAlign = "left";
    context.fillText(t("time / s"), 4, plot.bottom + 5);
    context.textBaseline = "alphabetic";
    context.textAlign = "right";
    context.fillText(t("{span} shown", { span }), plot.right, plot.top - 5);
    for (const scale of this.scales) {
      this.drawScale(scale);
    }
    if (this.scales.length === 0) {
      context.strokeStyle = colours.border;
      context.strokeRect(plot.left + 0.5, plot.top + 0.5, plot.right - plot.left - 1, plot.bottom - plot.top - 1);
    }
  }

  private drawScale(scale: Scale): void {
    const { context, colours } = this;
    const { box, gutter, range } = scale;
    const kTickHeight = 26;
    const { step, at } = ticks(range.from, range.to, Math.max(1, (box.bottom - box.top) / kTickHeight));
    const only = this.scales.every((other) => other === scale || other.box.top !== box.top);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const level of at) {
      const y = Math.round(this.yOf(scale, level)) + 0.5;
      if (only || scale === this.scales[0]) {
        context.strokeStyle = colours.grid;
        line(context, box.left, y, box.right, y);
      }
      if (y > box.top + 20 && y < box.bottom - 2) {
        context.fillStyle = colours.soft;
        context.fillText(tickText(level, step), gutter.right - 5, y);
      }
    }
    context.strokeStyle = colours.border;
    context.strokeRect(box.left + 0.5, box.top + 0.5, box.right - box.left - 1, box.bottom - box.top - 1);
    context.textBaseline = "top";
    context.textAlign = "right";
    context.fillStyle = scale.channels.length === 1 ? this.colour(scale.channels[0]!) : colours.text;
    context.fillText(scale.label, gutter.right - 5, gutter.top + 1);
    if (!only) {
      context.strokeStyle = context.fillStyle;
      line(context, gutter.right - 0.5, gutter.top, gutter.right - 0.5, gutter.bottom);
    }
  }

  private colour(channel: number): string {
    return this.colours.series[channel % kSeries]!;
  }

  /// On its scale, a value of a channel stands at value * slope + zero.
  private line(channel: ChannelSetup): { readonly slope: number; readonly zero: number } {
    const { factor } = this.scope.display(channel);
    return { slope: channel.gain * factor, zero: channel.offset * factor };
  }

  /// y = value * slope + zero
  private placed(scale: Scale, channel: number): { readonly slope: number; readonly zero: number } {
    const { slope, zero } = this.line(this.scope.setup.channels[channel]!);
    const { range, box } = scale;
    const perUnit = (box.top - box.bottom) / (range.to - range.from);
    return { slope: perUnit * slope, zero: box.bottom + (zero - range.from) * perUnit };
  }

  private drawEnvelopes(bounds: Float64Array): void {
    const { plot, ratio, context } = this;
    const width = bounds.length - 1;
    if (this.envelope.low.length !== width) {
      this.envelope = makeEnvelope(width);
    }
    this.layer.begin(width, Math.max(1, Math.round((plot.bottom - plot.top) * ratio)));
    for (const scale of this.scales) {
      const top = Math.round((scale.box.top - plot.top) * ratio);
      const bottom = Math.round((scale.box.bottom - plot.top) * ratio);
      for (const channel of scale.channels) {
        const { slope, zero } = this.placed(scale, channel);
        envelopeOf(this.scope.record.ring, channel, bounds, this.envelope);
        this.layer.trace(this.envelope, slope * ratio, (zero - plot.top) * ratio, top, bottom, pixelOf(this.colour(channel)), ratio);
      }
    }
    context.save();
    context.resetTransform();
    this.layer.end(context, Math.round(plot.left * ratio), Math.round(plot.top * ratio));
    context.restore();
  }

  private drawSamples(channel: number, from: number, to: number, slope: number, zero: number): void {
    const { context } = this;
    const { ring } = this.scope.record;
    const { period } = this.scope.setup;
    const first = Math.max(ring.first, from - 1);
    const last = Math.min(ring.end, to + 1);
    const nanosecond = (this.plot.right - this.plot.left) / (this.shown.to - this.shown.from);
    const kDots = 8;
    const dots = period * nanosecond >= kDots;
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    context.beginPath();
    let before = NaN;
    for (let row = first; row < last; ++row) {
      const value = ring.value(channel, row);
      const time = ring.time(row);
      if (Number.isNaN(value)) {
        before = NaN;
        continue;
      }
      const x = this.plot.left + (time - this.shown.from) * nanosecond;
      const y = value * slope + zero;
      if (time - before <= 1.5 * period) {
        context.lineTo(x, y);
      } else {
        context.moveTo(x, y);
      }
      before = time;
      if (dots) {
        context.fillRect(x - 2, y - 2, 4, 4);
      }
    }
    context.stroke();
  }

  private drawGaps(): void {
    const { context, colours, plot } = this;
    context.globalAlpha = 0.25;
    context.fillStyle = colours.soft;
    for (const gap of this.scope.record.gaps) {
      const from = Math.max(plot.left, this.xOf(gap.from));
      const to = Math.min(plot.right, this.xOf(gap.to));
      if (to > plot.left && from < plot.right) {
        context.fillRect(from, plot.top, Math.max(1, to - from), plot.bottom - plot.top);
      }
    }
    context.globalAlpha = 1;
  }

  private drawTrigger(): void {
    const { context, colours, plot, scope } = this;
    const { source } = scope.setup.trigger;
    const frame = scope.acquisition.frame;
    context.strokeStyle = colours.accent;
    context.fillStyle = colours.accent;
    if (frame !== null && frame.trigger >= this.shown.from && frame.trigger <= this.shown.to) {
      const x = Math.round(this.xOf(frame.trigger)) + 0.5;
      triangle(context, x, plot.top, 0, 1);
      dashed(context, [2, 3], () => line(context, x, plot.top, x, plot.bottom));
      context.textAlign = "left";
      context.textBaseline = "alphabetic";
      context.fillText("T", x + 6, plot.top - 5);
    }
    if (source.kind === "level") {
      const index = scope.setup.channels.findIndex(({ name }) => name === source.channel);
      const scale = this.scales.find(({ channels }) => channels.includes(index));
      if (scale !== undefined) {
        const { slope, zero } = this.line(scope.setup.channels[index]!);
        const y = this.yOf(scale, source.level * slope + zero);
        if (y >= scale.box.top && y <= scale.box.bottom) {
          triangle(context, scale.box.left, y, 1, 0);
          dashed(context, [2, 5], () => line(context, scale.box.left, y, scale.box.right, y));
        }
      }
    }
  }

  private drawEvents(): void {
    const { context, colours, plot } = this;
    for (const event of this.scope.events) {
      const x = this.xOf(event.time_ns);
      if (x >= plot.left && x <= plot.right) {
        context.fillStyle = event.severity === "fault" ? colours.bad : colours.soft;
        triangle(context, x, plot.bottom, 0, -1);
      }
    }
  }

  private drawCursors(): void {
    const { context, colours, plot } = this;
    const { times, levels } = this.scope.cursors;
    context.strokeStyle = colours.text;
    context.fillStyle = colours.text;
    context.textBaseline = "alphabetic";
    context.textAlign = "center";
    context.lineWidth = 1;
    const flag = (text: string, x: number, y: number) => {
      const half = context.measureText(text).width / 2 + 4;
      context.fillStyle = colours.text;
      context.fillRect(x - half, y - 7, 2 * half, 14);
      context.fillStyle = colours.surface;
      context.textBaseline = "middle";
      context.fillText(text, x, y + 0.5);
    };
    if (times !== null) {
      for (const [name, time] of [
        ["A", times.a],
        ["B", times.b],
      ] as const) {
        const x = Math.round(this.xOf(time)) + 0.5;
        if (x >= plot.left && x <= plot.right) {
          dashed(context, [6, 3], () => line(context, x, plot.top, x, plot.bottom));
          flag(name, x, plot.top - 8);
        }
      }
    }
    const scale = this.scales.find(({ key }) => key === levels?.key);
    if (levels !== null && scale !== undefined) {
      for (const [name, level] of [
        ["C", levels.a],
        ["D", levels.b],
      ] as const) {
        const y = Math.round(this.yOf(scale, level)) + 0.5;
        if (y >= scale.box.top && y <= scale.box.bottom) {
          dashed(context, [6, 3], () => line(context, scale.box.left, y, scale.box.right, y));
          flag(name, scale.box.right - 10, y);
        }
      }
    }
  }
}

export function line(context: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

function dashed(context: CanvasRenderingContext2D, pattern: number[], draw: () => void): void {
  context.setLineDash(pattern);
  draw();
  context.setLineDash([]);
}

/// With its tip at (x, y), pointing to (dx, dy).
function triangle(context: CanvasRenderingContext2D, x: number, y: number, dx: number, dy: number): void {
  const kSize = 7;
  context.beginPath();
  context.moveTo(x + dx * 2, y + dy * 2);
  context.lineTo(x - dx * kSize + dy * 5, y - dy * kSize + dx * 5);
  context.lineTo(x - dx * kSize - dy * 5, y - dy * kSize - dx * 5);
  context.closePath();
  context.fill();
}
