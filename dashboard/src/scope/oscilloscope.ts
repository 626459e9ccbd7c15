// The oscilloscope itself: what it is set to, what it has recorded, what it shows.
import type { Api, Event, Problem, Subscribed } from "../api";
import { t } from "../language";
import type { Conversion } from "../motion_units";
import { Connection, type ConnectionListener, type Wanted } from "./connection";
import type { CursorPair } from "./core/cursors";
import { ExpressionError, channelsOf, parseExpression, unitOf } from "./core/expression";
import { type Measurement, measure } from "./core/measure";
import { ScopeRecord } from "./core/record";
import { type AxisSetup, type ChannelSetup, type Setup, kDefaultSetup, kShortestPeriod } from "./core/setup";
import { Acquisition, type Detector, eventTriggers, makeDetector } from "./core/trigger";
import { type Range, nextSpan, panned, zoomed } from "./core/view";
import type { SamplesFromWorker } from "./worker_messages";

export interface Cursors {
  readonly times: CursorPair | null;
  /// `key` is that of the axis.
  readonly levels: (CursorPair & { readonly key: string }) | null;
}

export interface Statistics {
  readonly received: number;
  readonly expected: number;
  readonly droppedByServer: number;
  readonly droppedByPage: number;
  /// Frames the browser has drawn in the last second, and the longest time between two of them, ms.
  readonly fps: number;
  readonly slowest: number;
}

const kMostEvents = 200;
const kNotifyEvery = 200; // ms
const kRackSays = `${t("The rack:")} `;

export class Oscilloscope implements ConnectionListener {
  setup: Setup = kDefaultSetup;
  running = true;
  isConnected = false;
  problem = "";
  cursors: Cursors = { times: null, levels: null };
  measurements: (Measurement | null)[] = [];
  events: Event[] = [];
  readonly record = new ScopeRecord(kDefaultSetup.memory, kDefaultSetup.period);
  acquisition = new Acquisition(kDefaultSetup.trigger, kDefaultSetup.span);
  /// What the user looks at instead of what the acquisition shows.
  held: Range | null = null;
  /// Counts up with everything that changes the picture.
  revision = 0;
  statistics: Statistics = { received: 0, expected: 0, droppedByServer: 0, droppedByPage: 0, fps: 0, slowest: 0 };
  private droppedByServer = 0;
  private droppedByPage = 0;
  private isLoading = false;
  private detector: Detector | null = null;
  private detectorColumn = -1;
  private armedAt = -Infinity;
  private readonly connection: Connection;
  private readonly listeners = new Set<() => void>();
  private convert: (signal: string, unit: string) => Conversion = (_, unit) => ({ unit, factor: 1 });
  private notified = 0;
  private measuredNext = 0;
  private frameTimes: number[] = [];

  constructor(api: Api) {
    this.connection = new Connection(api, this);
  }

  close(): void {
    this.connection.close();
    this.listeners.clear();
  }

  onChange(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  private notify(): void {
    ++this.revision;
    this.notified = performance.now();
    this.listeners.forEach((listener) => listener());
  }

  // What the stream brings

  connected(open: boolean): void {
    this.isConnected = open;
    this.record.interrupt();
    this.notify();
  }

  subscribed(message: Subscribed): void {
    this.record.subscribed(message.signals.map(({ name }) => name));
    const { signals, period } = this.wanted();
    const names = new Set(signals);
    // Setups may be loaded faster than the rack answers: only the answer to the last one begins its record.
    if (
      this.isLoading &&
      message.period_ns === period &&
      message.signals.length === names.size &&
      message.signals.every(({ name }) => names.has(name))
    ) {
      this.isLoading = false;
      this.record.clear();
      this.arm();
    }
    if (this.problem.startsWith(kRackSays)) {
      this.problem = "";
    }
    const units = new Map(message.signals.map(({ name, unit }) => [name, unit]));
    const channels = this.setup.channels.map((channel) =>
      channel.expression === null && units.has(channel.name) ? { ...channel, unit: units.get(channel.name)! } : channel,
    );
    if (channels.some((channel, i) => channel.unit !== this.setup.channels[i]!.unit)) {
      this.change({ channels });
    }
  }

  samples(batch: SamplesFromWorker): void {
    this.droppedByServer = batch.droppedByServer;
    this.droppedByPage = batch.droppedByPage;
    if (!this.running || this.isLoading) {
      return;
    }
    const newest = this.record.ring.newest;
    const from = this.record.append(batch);
    if (this.record.ring.oldest > newest || batch.times[0]! <= newest) {
      this.arm(); // time was put back
    }
    const { ring } = this.record;
    for (let row = from; row < ring.end; ++row) {
      const time = ring.time(row);
      if (this.detector !== null && this.detectorColumn >= 0) {
        const found = this.detector.feed(time, ring.value(this.detectorColumn, row));
        if (!Number.isNaN(found)) {
          this.acquisition.offer(found);
        }
      }
      this.acquisition.advance(time);
    }
    this.finish();
    ++this.revision;
  }

  receiveEvents(events: readonly Event[]): void {
    this.events = [...this.events, ...events].slice(-kMostEvents);
    for (const event of events) {
      if (
        this.running &&
        event.time_ns >= this.armedAt &&
        eventTriggers(this.setup.trigger.source, event) &&
        this.acquisition.offer(event.time_ns)
      ) {
        this.acquisition.advance(this.record.ring.newest);
      }
    }
    this.finish();
    this.notify();
  }

  receiveProblem(problem: Partial<Problem>): void {
    this.problem = kRackSays + (problem.detail ?? problem.title ?? t("something is wrong"));
    this.notify();
  }

  private finish(): void {
    if (this.acquisition.state === "done" && this.running) {
      this.running = false;
      this.subscribe();
      this.notify();
    }
  }

  // Run control

  run(): void {
    this.running = true;
    this.held = null;
    this.record.interrupt();
    this.arm();
    this.subscribe();
    this.notify();
  }

  stop(): void {
    this.running = false;
    this.held ??= this.shown();
    this.subscribe();
    this.notify();
  }

  single(): void {
    this.change({ trigger: { ...this.setup.trigger, mode: "single" } });
    this.run();
  }

  /// As if the trigger had come just now.
  force(): void {
    if (this.running && this.record.ring.size > 0) {
      this.acquisition.offer(this.record.ring.newest);
      this.notify();
    }
  }

  private arm(): void {
    const { trigger, span, channels } = this.setup;
    this.acquisition = new Acquisition(trigger, span);
    this.detector = makeDetector(trigger.source);
    this.armedAt = this.record.ring.size > 0 ? this.record.ring.newest : -Infinity;
    this.detectorColumn =
      "channel" in trigger.source ? channels.findIndex(({ name }) => name === (trigger.source as { channel: string }).channel) : -1;
  }

  private wanted(): Wanted {
    const { channels, period } = this.setup;
    const signals = this.running ? channels.filter(({ expression }) => expression === null).map(({ name }) => name) : [];
    return { signals, period, events: true };
  }

  private subscribe(): void {
    this.connection.want(this.wanted());
  }

  // Setup

  /// Throws what is wrong with an expression before anything is changed.
  change(patch: Partial<Setup>): void {
    if (this.apply(patch)) {
      this.record.interrupt();
      this.subscribe();
    }
    this.notify();
  }

  /// Returns whether other samples are wanted of the rack than before.
  private apply(patch: Partial<Setup>): boolean {
    const before = this.setup;
    const next = { ...before, ...patch };
    checkChannels(next.channels);
    this.setup = next;
    this.record.configure(next.channels, next.period, next.memory);
    this.measurements = next.channels.map(
      (channel) => this.measurements[before.channels.findIndex(({ name }) => name === channel.name)] ?? null,
    );
    const signals = (setup: Setup) =>
      setup.channels
        .filter(({ expression }) => expression === null)
        .map(({ name }) => name)
        .join();
    const place = "channel" in next.trigger.source ? next.trigger.source.channel : "";
    const column = (setup: Setup) => setup.channels.findIndex(({ name }) => name === place);
    if (next.trigger !== before.trigger || next.period !== before.period || column(next) !== column(before)) {
      this.arm();
    } else if (next.span !== before.span) {
      this.acquisition.setSpan(next.span);
    }
    return next.period !== before.period || signals(next) !== signals(before);
  }

  load(setup: Setup): void {
    this.held = null;
    this.cursors = { times: null, levels: null };
    this.apply(setup);
    this.isLoading = true; // rows of the subscription before may still come: they are none of this record
    this.record.clear();
    this.arm();
    this.subscribe(); // once: a second one would leave a gap in the record
    this.notify();
  }

  addSignals(signals: readonly { readonly name: string; readonly unit: string }[]): void {
    const known = new Set(this.setup.channels.map(({ name }) => name));
    const added = signals
      .filter(({ name }) => !known.has(name))
      .map(({ name, unit }): ChannelSetup => ({ name, unit, expression: null, visible: true, gain: 1, offset: 0, own: false }));
    this.change({ channels: [...this.setup.channels, ...added] });
  }

  /// An empty unit: what follows from the expression.
  addExpression(name: string, expression: string, unit: string): void {
    const node = parseExpression(expression);
    const units = new Map(this.setup.channels.map((channel) => [channel.name, channel.unit]));
    const found = unit === "" ? unitOf(node, (channel) => units.get(channel) ?? "") : unit;
    this.change({
      channels: [...this.setup.channels, { name, unit: found, expression, visible: true, gain: 1, offset: 0, own: false }],
    });
  }

  changeChannel(name: string, patch: Partial<ChannelSetup>): void {
    this.change({ channels: this.setup.channels.map((channel) => (channel.name === name ? { ...channel, ...patch } : channel)) });
  }

  removeChannel(name: string): void {
    this.change({ channels: this.setup.channels.filter((channel) => channel.name !== name) });
  }

  /// Shows positions and velocities in other units from now on. Record, expressions and trigger stay in those of the signals.
  showIn(convert: (signal: string, unit: string) => Conversion): void {
    this.convert = convert;
    this.setCursors({ levels: null });
  }

  /// The unit in which a channel is shown, and by what its values are multiplied for that.
  display(channel: ChannelSetup): Conversion {
    return this.convert(channel.name, channel.unit);
  }

  /// The axis of a channel.
  axisKey(channel: ChannelSetup): string {
    return channel.own ? `=${channel.name}` : this.display(channel).unit;
  }

  axis(key: string): AxisSetup {
    return this.setup.axes.find((axis) => axis.key === key) ?? { key, range: null };
  }

  changeAxis(key: string, range: Range | null): void {
    this.change({ axes: [...this.setup.axes.filter((axis) => axis.key !== key), { key, range }] });
  }

  setCursors(patch: Partial<Cursors>): void {
    this.cursors = { ...this.cursors, ...patch };
    this.notify();
  }

  // What is looked at

  shown(): Range {
    if (this.held !== null) {
      return this.held;
    }
    const { ring } = this.record;
    const newest = ring.size === 0 ? this.setup.span : ring.newest;
    const frame = this.acquisition.shown(newest);
    return frame === null ? { from: newest - this.setup.span, to: newest } : { from: frame.start, to: frame.end };
  }

  hold(range: Range): void {
    this.held = range;
    this.notify();
  }

  follow(): void {
    this.held = null;
    this.notify();
  }

  zoom(factor: number, anchor: number): void {
    const kFewest = 8;
    const longest = Math.max(this.record.depth, this.setup.span);
    this.hold(zoomed(this.shown(), factor, anchor, kFewest * kShortestPeriod * 0.25, longest));
  }

  pan(share: number): void {
    const range = this.shown();
    this.hold(panned(range, share * (range.to - range.from)));
  }

  stepSpan(direction: 1 | -1): void {
    const next = nextSpan(this.setup.span, direction);
    if (next >= 1e6 && next <= 3600e9) {
      this.change({ span: next });
    }
  }

  /// Rows between the time cursors if there are any, else those that are shown.
  measuredRows(): { readonly from: number; readonly to: number } {
    const { ring } = this.record;
    const { times } = this.cursors;
    const range = times === null ? this.shown() : { from: Math.min(times.a, times.b), to: Math.max(times.a, times.b) };
    const from = ring.lowerBound(range.from);
    return { from, to: Math.max(from, ring.lowerBound(range.to + 1)) };
  }

  /// To be called with every frame of the browser: does a part of what takes time.
  tick(now: number): void {
    this.frameTimes.push(now);
    while (this.frameTimes[0]! < now - 1000) {
      this.frameTimes.shift();
    }
    const { channels } = this.setup;
    if (channels.length > 0) {
      this.measuredNext = (this.measuredNext + 1) % Math.max(channels.length, 12);
      if (this.measuredNext < channels.length) {
        const { from, to } = this.measuredRows();
        this.measurements[this.measuredNext] = measure(this.record.ring, this.measuredNext, from, to);
      }
    }
    if (now - this.notified > kNotifyEvery) {
      const steps = this.frameTimes.slice(1).map((time, i) => time - this.frameTimes[i]!);
      this.statistics = {
        received: this.record.received,
        expected: this.record.expected,
        droppedByServer: this.droppedByServer,
        droppedByPage: this.droppedByPage,
        fps: steps.length,
        slowest: Math.max(0, ...steps),
      };
      this.notify();
    }
  }
}

/// Names are unique and expressions can be calculated.
function checkChannels(channels: readonly ChannelSetup[]): void {
  const known = new Set<string>();
  for (const { name, expression } of channels) {
    if (name.trim() === "" || known.has(name)) {
      throw new ExpressionError(name.trim() === "" ? t("a channel needs a name") : t('there is a channel "{name}" already', { name }), 0);
    }
    if (expression !== null) {
      for (const channel of channelsOf(parseExpression(expression))) {
        if (!known.has(channel)) {
          throw new ExpressionError(t('"{name}" reads "{channel}", which is no channel before it; add it first', { name, channel }), 0);
        }
      }
    }
    known.add(name);
  }
}
