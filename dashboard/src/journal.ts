// What was done to the rack from this page, in order, for whoever wants to have it done again by a test.
import { signal } from "@preact/signals";

import type { Api, Written } from "./api";

/// What a person expects of a signal at this place.
export interface Expectation {
  readonly signal: string;
  readonly comparison: "above" | "below" | "equals";
  readonly value: number;
  /// For "equals".
  readonly tolerance: number;
  /// In seconds.
  readonly within: number;
}

/// `at`: ms, by the page's clock.
export type Action =
  | { readonly at: number; readonly kind: "write"; readonly write: Written }
  | { readonly at: number; readonly kind: "expectation"; readonly expectation: Expectation };

/// What changes devices or what is around them; not the rack itself, nor questions that are asked with a body.
const kKept = /^\/api\/v1\/(devices|inputs|faults)\b/;
const kMost = 500;
const kDragged = 500; ///< ms within which a slider that is being moved writes again

/// Whether the later of two writes only goes on with the earlier one: a slider on its way, a button that is still held.
function goesOn(before: Action, at: number, { method, path, body }: Written): boolean {
  if (before.kind !== "write" || before.write.method !== method || before.write.path !== path) {
    return false;
  }
  const held = JSON.stringify(before.write.body) === JSON.stringify(body) && (body as { command?: string } | undefined)?.command === "jog";
  return held || (path.startsWith("/api/v1/inputs/") && at - before.at < kDragged);
}

export class Journal {
  readonly actions = signal<readonly Action[]>([]);
  private run: string | null = null;

  constructor(
    api: Api,
    private readonly now: () => number = () => performance.now(),
  ) {
    api.onWritten((write) => kKept.test(write.path) && this.add(write));
  }

  expect(expectation: Expectation): void {
    this.append({ at: this.now(), kind: "expectation", expectation });
  }

  clear(): void {
    this.actions.value = [];
  }

  /// Told of the run that the rack is at: what was done to another one is no business of it.
  follow(run: string): void {
    if (this.run !== null && this.run !== run) {
      this.clear();
    }
    this.run = run;
  }

  private add(write: Written): void {
    const at = this.now();
    const before = this.actions.value.at(-1);
    if (before === undefined || !goesOn(before, at, write)) {
      this.append({ at, kind: "write", write });
    } else if (write.path.startsWith("/api/v1/inputs/")) {
      this.actions.value = [...this.actions.value.slice(0, -1), { at, kind: "write", write }];
    }
  }

  private append(action: Action): void {
    this.actions.value = [...this.actions.value, action].slice(-kMost);
  }
}
