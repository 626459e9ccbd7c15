// What the page and its worker tell each other.
import type { Event, Problem, Subscribed } from "../api_types";

export type ToWorker =
  | { readonly kind: "open"; readonly url: string; readonly protocols: readonly string[] }
  | { readonly kind: "send"; readonly text: string }
  /// The page has taken so many messages.
  | { readonly kind: "taken"; readonly messages: number }
  | { readonly kind: "close" };

export interface SamplesFromWorker {
  readonly kind: "samples";
  readonly rows: number;
  readonly times: Float64Array;
  readonly columns: readonly Float64Array[];
  /// Rows that the server, and the worker, had to drop since the stream began.
  readonly droppedByServer: number;
  readonly droppedByPage: number;
}

export type FromWorker =
  | { readonly kind: "opened" }
  | { readonly kind: "closed"; readonly reason: string }
  | { readonly kind: "subscribed"; readonly message: Subscribed }
  | { readonly kind: "events"; readonly events: readonly Event[] }
  | { readonly kind: "problem"; readonly problem: Partial<Problem> }
  | SamplesFromWorker;
