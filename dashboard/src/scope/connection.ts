// The page's end of the worker: opens the stream, keeps it open, says what is wanted.
import type { Api, Event, Problem, Subscribed } from "../api";
import { t } from "../language";
import type { FromWorker, SamplesFromWorker, ToWorker } from "./worker_messages";

export interface Wanted {
  readonly signals: readonly string[];
  /// ns
  readonly period: number;
  readonly events: boolean;
}

export interface ConnectionListener {
  connected(open: boolean): void;
  subscribed(message: Subscribed): void;
  samples(batch: SamplesFromWorker): void;
  receiveEvents(events: readonly Event[]): void;
  receiveProblem(problem: Partial<Problem>): void;
}

const kRetry = 1000; // ms

export class Connection {
  private readonly worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
  private readonly forget: () => void;
  private isOpen = false;
  private timer = 0;
  private wanted: Wanted = { signals: [], period: 1_000_000, events: false };

  constructor(
    private readonly api: Api,
    private readonly listener: ConnectionListener,
  ) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.take(data);
    this.worker.onerror = (event) =>
      listener.receiveProblem({ detail: t("the page's worker does not run: {reason}", { reason: event.message || t("reload the page") }) });
    this.forget = api.onToken(() => this.open());
    this.open();
  }

  want(wanted: Wanted): void {
    this.wanted = wanted;
    if (this.isOpen) {
      this.subscribe();
    }
  }

  close(): void {
    clearTimeout(this.timer);
    this.forget();
    this.post({ kind: "close" });
    this.worker.terminate();
  }

  private post(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private open(): void {
    clearTimeout(this.timer);
    const protocols = ["stator.signals.v1"];
    if (this.api.token !== "") {
      protocols.push(`token.${this.api.token}`);
    }
    this.post({ kind: "open", url: location.origin.replace(/^http/, "ws") + "/api/v1/signals", protocols });
  }

  private subscribe(): void {
    const { signals, period, events } = this.wanted;
    this.post({
      kind: "send",
      text: JSON.stringify({ signals, period: `${period / 1000}us`, format: "binary", events }),
    });
  }

  private take(message: FromWorker): void {
    this.post({ kind: "taken", messages: 1 });
    switch (message.kind) {
      case "opened":
        this.isOpen = true;
        this.listener.connected(true);
        this.subscribe();
        break;
      case "closed":
        this.isOpen = false;
        this.listener.connected(false);
        this.timer = window.setTimeout(() => this.open(), kRetry);
        break;
      case "subscribed":
        this.listener.subscribed(message.message);
        break;
      case "samples":
        this.listener.samples(message);
        break;
      case "events":
        this.listener.receiveEvents(message.events);
        break;
      case "problem":
        this.listener.receiveProblem(message.problem);
        break;
    }
  }
}
