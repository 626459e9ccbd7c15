// Which setup the oscilloscope has: a preset, or one of a person's own; in the address as well.
import { useEffect, useRef, useState } from "preact/hooks";

import { t } from "../language";
import { href } from "../router";
import { choosingOf, queryOfChoosing, queryOfSetup, setupOfQuery } from "./core/address";
import { type Choosing, type Place, setupOf } from "./core/presets";
import { type Setup, kDefaultSetup } from "./core/setup";
import type { Leaf } from "./core/tree";
import { rememberSetup, rememberedSetup } from "./files";
import type { Oscilloscope } from "./oscilloscope";

export interface Shown {
  /// Null: nothing that is offered, or it has been changed since.
  readonly choosing: Choosing | null;
  /// Of which it was; null: of none.
  readonly place: Place | null;
  readonly choose: (choosing: Choosing) => void;
  /// Shows the setup that a person has made here before; null: there is none.
  readonly recall: (() => void) | null;
}

interface ShownOf {
  readonly scope: Oscilloscope;
  readonly signals: readonly Leaf[];
  readonly offered: readonly Choosing[];
  readonly query: ReadonlyMap<string, string>;
  readonly setWrong: (problem: string) => void;
}

/// A setup that is of use here: this rack has one of its signals at least.
function ownSetup(signals: readonly Leaf[]): Setup | null {
  const own = rememberedSetup();
  const names = new Set(signals.map(({ name }) => name));
  return own !== null && own.channels.some(({ name }) => names.has(name)) ? own : null;
}

export function useShown({ scope, signals, offered, query, setWrong }: ShownOf): Shown {
  const [chosen, setChosen] = useState<Choosing | null>(null);
  /// The setup as it came, by the address or from where it was kept: not to be kept anew.
  const given = useRef("");
  const choose = (choosing: Choosing) => {
    const setup = setupOf(choosing.preset, choosing.place, signals)!;
    given.current = JSON.stringify(setup);
    setChosen(choosing);
    scope.load(setup);
    if (!scope.running) {
      scope.run();
    }
  };
  const recall = (setup: Setup) => {
    given.current = JSON.stringify(setup);
    setChosen(null);
    scope.load(setup);
  };
  // Also when the address changes while this is open, e.g. by the way back.
  useEffect(() => {
    const text = query.get("setup");
    const own = text === undefined && query.size === 0 ? ownSetup(signals) : null;
    if (text !== undefined) {
      try {
        recall(setupOfQuery(text));
      } catch (error) {
        setWrong((error as Error).message);
      }
    } else if (query.size === 0 && scope.setup.channels.length > 0) {
      writeAddress();
    } else if (own !== null) {
      recall(own);
    } else {
      const found = choosingOf(query, offered);
      if (found !== null) {
        choose(found);
      } else if (query.size > 0) {
        const asked = [...query].map(([key, value]) => `${key} "${value}"`).join(", ");
        setWrong(
          t(
            "There is nothing to show for {asked}: the rack has no such device or axis, or it lacks the signals; switch signals on in the list.",
            { asked },
          ),
        );
      }
    }
  }, [query]);
  const { setup } = scope;
  const isGiven = JSON.stringify(setup) === given.current;
  const choosing = isGiven ? chosen : null;
  const writeAddress = () => {
    const place = href("scope", [], choosing === null ? queryOfSetup(setup) : queryOfChoosing(choosing));
    if (place !== location.hash) {
      history.replaceState(history.state, "", place);
    }
  };
  useEffect(() => {
    if (setup === kDefaultSetup) {
      return;
    }
    if (!isGiven) {
      rememberSetup(setup);
    }
    writeAddress();
  }, [setup, choosing]);
  const own = choosing === null ? null : ownSetup(signals);
  return { choosing, place: chosen?.place ?? null, choose, recall: own === null ? null : () => recall(own) };
}
