// Live values of signals: one WebSocket for all that is visible, whatever the number of views.

import { batch, signal, type ReadonlySignal, type Signal } from "@preact/signals";

import type { Api, SignalMessage, Signals } from "./api";
import { closeSocket } from "./close_socket";

const kPeriod = "40ms";
const kRetry = 1000;
const kShownPeriod = 120; ///< ms between two values that a person is to read
/// Names may be long; a request's head is limited to 8 KiB.
const kNamesAtOnce = 60;

export interface Live {
  readonly value: number | null;
  readonly unit: string;
}

export class SignalHub {
  timeNs = 0;
  private readonly users = new Map<string, number>();
  private readonly fresh = new Set<string>(); ///< wanted by somebody since the last message
  private readonly values = new Map<string, Live>();
  private readonly shown = new Map<string, Signal<Live | undefined>>();
  private shownAt = 0;
  private showing: ReturnType<typeof setTimeout> | undefined;
  private readonly listeners = new Set<() => void>();
  private socket: WebSocket | null = null;
  private order: readonly { name: string; unit: string }[] = [];
  private announced = "";
  private pending = false;
  private notifying = false;

  constructor(private readonly api: Api) {
    document.addEventListener("visibilitychange", () => this.schedule());
  }

  value(name: string): Live | undefined {
    return this.values.get(name);
  }

  /// The same to be read by a person: what reads it in a component renders that component again, and nothing else, when
  /// it has changed. It changes while somebody watches `name`.
  live(name: string): ReadonlySignal<Live | undefined> {
    let found = this.shown.get(name);
    if (!found) {
      found = signal(this.values.get(name));
      this.shown.set(name, found);
    }
    return found;
  }

  /// Values that an answer of the server had, for names of which none are known yet: shown until newer ones come.
  offer(signals: Signals["signals"]): void {
    for (const { name, unit, value } of signals) {
      if (!this.values.has(name)) {
        this.values.set(name, { value, unit });
      }
    }
  }

  watch(names: readonly string[], listener: () => void = () => {}): () => void {
    for (const name of names) {
      if (!this.users.has(name)) {
        this.fresh.add(name);
      }
      this.users.set(name, (this.users.get(name) ?? 0) + 1);
    }
    this.listeners.add(listener);
    this.schedule();
    return () => {
      this.listeners.delete(listener);
      for (const name of names) {
        const left = (this.users.get(name) ?? 1) - 1;
        if (left > 0) {
          this.users.set(name, left);
        } else {
          this.users.delete(name);
        }
      }
      this.schedule();
    };
  }

  /// In lockstep no samples come while the master rests; these values do.
  private async fetchNow(names: readonly string[]): Promise<void> {
    for (let i = 0; i < names.length; i += kNamesAtOnce) {
      const list = names
        .slice(i, i + kNamesAtOnce)
        .map(encodeURIComponent)
        .join(",");
      try {
        const { signals } = await this.api.get<Signals>(`/api/v1/signals?names=${list}`);
        for (const { name, unit, value } of signals) {
          this.values.set(name, { value, unit });
        }
        this.notify();
      } catch {
        // The connection's state is shown elsewhere, and values follow when it is back.
      }
    }
  }

  /// Views come and go several at a time; one message is enough for that.
  private schedule(): void {
    if (!this.pending) {
      this.pending = true;
      setTimeout(() => {
        this.pending = false;
        const fresh = [...this.fresh].filter((name) => this.users.has(name));
        this.fresh.clear();
        void this.fetchNow(fresh);
        this.announce();
      }, 20);
    }
  }

  private announce(): void {
    const names = document.hidden ? [] : [...this.users.keys()].sort();
    if (names.length === 0) {
      this.close();
      return;
    }
    if (!this.socket) {
      this.open();
      return;
    }
    const message = JSON.stringify({ signals: names, period: kPeriod });
    if (this.socket.readyState === WebSocket.OPEN && message !== this.announced) {
      this.announced = message;
      this.socket.send(message);
    }
  }

  private open(): void {
    const socket = this.api.socket("/api/v1/signals");
    this.socket = socket;
    this.announced = "";
    socket.onopen = () => this.announce();
    socket.onmessage = (event: MessageEvent<string>) => {
      if (this.socket === socket) {
        this.take(JSON.parse(event.data) as SignalMessage);
      }
    };
    socket.onclose = () => {
      if (this.socket === socket) {
        this.socket = null;
        setTimeout(() => this.schedule(), kRetry);
      }
    };
  }

  private close(): void {
    const socket = this.socket;
    this.socket = null;
    closeSocket(socket);
  }

  private take(message: SignalMessage): void {
    if (message.type === "subscribed") {
      this.order = message.signals;
    } else if (message.type === "samples") {
      this.timeNs = message.time_ns[message.time_ns.length - 1] ?? this.timeNs;
      this.order.forEach(({ name, unit }, i) => {
        const column = message.values[i];
        if (column && column.length > 0) {
          this.values.set(name, { value: column[column.length - 1] ?? null, unit });
        }
      });
      this.notify();
    }
  }

  private notify(): void {
    if (!this.notifying) {
      this.notifying = true;
      requestAnimationFrame(() => {
        this.notifying = false;
        for (const listener of this.listeners) {
          listener();
        }
        this.show();
      });
    }
  }

  private show(): void {
    clearTimeout(this.showing);
    this.showing = undefined;
    const wait = this.shownAt + kShownPeriod - performance.now();
    if (wait > 0) {
      this.showing = setTimeout(() => this.show(), wait);
      return;
    }
    this.shownAt = performance.now();
    batch(() => {
      for (const name of this.users.keys()) {
        const shown = this.shown.get(name);
        const now = this.values.get(name);
        const old = shown?.peek();
        if (shown && (now?.value !== old?.value || now?.unit !== old?.unit)) {
          shown.value = now;
        }
      }
    });
  }
}
