// What every view shares: whether the rack answers, its devices, what the server offers, its events.

import { ApiError, type Api, type Device, type Devices, type Event, type Events, type Rack } from "./api";

import { MasterActivity } from "./master_activity";

export type Connection = "connecting" | "online" | "lost" | "locked";

const kPeriod = 1000;
const kMostEvents = 5000;

export class RackStore {
  connection: Connection = "connecting";
  rack: Rack | null = null;
  devices: readonly Device[] = [];
  events: readonly Event[] = [];
  /// Whether masters speak, by network.
  readonly masters = new Map<string, MasterActivity>();
  /// Grows when the rack turns out to be another one: views start anew.
  epoch = 0;
  private offered: ReadonlySet<string> | null = null;
  private readonly listeners = new Set<() => void>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private running = false;

  constructor(readonly api: Api) {
    api.onToken(() => this.refresh());
  }

  start(): void {
    this.running = true;
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden) {
        this.refresh();
      }
    });
    void this.round();
  }

  stop(): void {
    this.running = false;
    clearTimeout(this.timer);
  }

  /// Looks at once instead of at the next second.
  refresh(): void {
    if (this.running) {
      clearTimeout(this.timer);
      void this.round();
    }
  }

  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /// Whether the server has this route, e.g. "/api/v1/traffic". Unknown is no.
  offers(path: string): boolean {
    return this.offered?.has(path) ?? false;
  }

  /// "ethercat", "can" or "serial"; empty: there is no such network.
  networkKind(name: string): string {
    return this.rack?.networks.find((network) => network.name === name)?.kind ?? "";
  }

  /// The device that a signal is of.
  deviceOf(signal: string): Device | undefined {
    return this.devices
      .filter(({ name }) => signal.startsWith(`${name}.`))
      .reduce<Device | undefined>((best, each) => (best && best.name.length >= each.name.length ? best : each), undefined);
  }

  private tell(): void {
    for (const listener of this.listeners) {
      listener();
    }
  }

  private async round(): Promise<void> {
    clearTimeout(this.timer);
    if (!document.hidden || this.connection !== "online") {
      await this.look();
      this.tell();
    }
    if (this.running) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => void this.round(), kPeriod);
    }
  }

  /// Asks for all at once, since each request waits for its turn in the rack.
  private async look(): Promise<void> {
    try {
      const begins = this.connection !== "online";
      const [rack, { devices }, offered] = await Promise.all([
        this.api.get<Rack>("/api/v1/rack"),
        this.api.get<Devices>("/api/v1/devices"),
        begins ? this.fetchOffered() : null,
      ]);
      const another = this.rack !== null && rack.run !== this.rack.run;
      if (another || begins) {
        this.offered = offered ?? (await this.fetchOffered());
        this.events = [];
        this.epoch += another || this.connection === "lost" ? 1 : 0;
      }
      this.rack = rack;
      this.watchMasters(rack);
      this.devices = devices;
      this.connection = "online";
      if (begins) {
        this.tell(); // views need not wait for events
      }
      await this.fetchEvents();
    } catch (error) {
      this.connection = error instanceof ApiError && error.unauthorised ? "locked" : "lost";
    }
  }

  private watchMasters(rack: Rack): void {
    for (const { name, received } of rack.networks) {
      const activity = this.masters.get(name) ?? new MasterActivity();
      this.masters.set(name, activity);
      activity.look(received, performance.now());
    }
  }

  private async fetchOffered(): Promise<ReadonlySet<string>> {
    const document = await this.api.get<{ paths?: Record<string, unknown> }>("/openapi.json");
    return new Set(Object.keys(document.paths ?? {}));
  }

  private async fetchEvents(): Promise<void> {
    const last = this.events[this.events.length - 1]?.number ?? 0;
    const { events } = await this.api.get<Events>(`/api/v1/events?after=${last}`);
    if (events.length > 0) {
      this.events = [...this.events, ...events].slice(-kMostEvents);
    }
  }
}
