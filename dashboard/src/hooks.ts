import { createContext } from "preact";
import { useCallback, useContext, useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";

import type { ReadonlySignal } from "@preact/signals";

import { ApiError, type Api, type Signals } from "./api";
import type { Journal } from "./journal";
import { t } from "./language";
import type { Live, SignalHub } from "./live";
import { conversion, motionUnit, type Conversion } from "./motion_units";
import type { RackStore } from "./store";

export interface World {
  readonly api: Api;
  readonly store: RackStore;
  readonly hub: SignalHub;
  readonly journal: Journal;
}

export const WorldContext = createContext<World | null>(null);

export function useWorld(): World {
  const world = useContext(WorldContext);
  if (!world) {
    throw new Error("a component stands outside the application");
  }
  return world;
}

/// Renders again whenever the store changes.
export function useStore(): RackStore {
  const { store } = useWorld();
  const [, render] = useState({});
  useEffect(() => store.subscribe(() => render({})), [store]);
  return store;
}

export interface Resource<T> {
  readonly data: T | null;
  readonly error: ApiError | null;
  /// When data came last, as performance.now() tells; null: none have come. Data that are the same as before render nothing
  /// again, so this is to be looked at from time to time.
  readonly at: { readonly current: number | null };
  readonly reload: () => void;
}

/// What the server has at `path`, fetched once at once, or (`period` > 0) every so many milliseconds while the page is
/// visible. Data stay when a later fetch fails. A null path fetches nothing.
export function useResource<T>(path: string | null, period = 0): Resource<T> {
  const { api } = useWorld();
  const [state, setState] = useState<{ path: string | null; data: T | null; error: ApiError | null }>({
    path: null,
    data: null,
    error: null,
  });
  const at = useRef<number | null>(null);
  const [round, setRound] = useState(0);
  useLayoutEffect(() => {
    at.current = null;
  }, [path]);
  // Without waiting for the page to be painted first.
  useLayoutEffect(() => {
    if (path === null) {
      return undefined;
    }
    const abort = new AbortController();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const fetchOnce = async () => {
      if (!document.hidden || period === 0) {
        try {
          const data = await api.get<T>(path, { signal: abort.signal });
          at.current = performance.now();
          // What has not changed renders nothing again.
          setState((old) =>
            old.path === path && old.error === null && JSON.stringify(old.data) === JSON.stringify(data)
              ? old
              : { path, data, error: null },
          );
        } catch (error) {
          if (abort.signal.aborted) {
            return;
          }
          const wrong = error instanceof ApiError ? error : new ApiError(0, { detail: String(error) });
          setState((old) => ({ path, data: old.path === path ? old.data : null, error: wrong }));
        }
      }
      if (period > 0 && !abort.signal.aborted) {
        timer = setTimeout(() => void fetchOnce(), period);
      }
    };
    void fetchOnce();
    return () => {
      abort.abort();
      clearTimeout(timer);
    };
  }, [api, path, period, round]);
  const reload = useCallback(() => setRound((n) => n + 1), []);
  const current = state.path === path;
  return { data: current ? state.data : null, error: current ? state.error : null, at, reload };
}

/// Signals by the pattern of their names, all if it is empty. Their values need not be waited for where they are shown first.
export function useSignalList(pattern = ""): Resource<Signals> {
  const { hub } = useWorld();
  const list = useResource<Signals>(`/api/v1/signals${pattern === "" ? "" : `?names=${pattern}`}`);
  useMemo(() => hub.offer(list.data?.signals ?? []), [hub, list.data]);
  return list;
}

/// A live value of a signal: what reads it is rendered again when it changes, and nothing else.
export function useLive(name: string): ReadonlySignal<Live | undefined> {
  const { hub } = useWorld();
  useEffect(() => hub.watch([name]), [hub, name]);
  return hub.live(name);
}

/// How a signal with a unit is shown: positions and velocities in the unit chosen. What calls this is rendered again when another
/// one is chosen.
export function useConversion(): (signal: string, unit: string) => Conversion {
  const { store } = useWorld();
  const chosen = motionUnit.value;
  return useCallback((signal, unit) => conversion(chosen, unit, store.deviceOf(signal)?.per_revolution ?? null), [store, chosen]);
}

/// The same for live values.
export function useShownIn(): (signal: string, live: Live | undefined) => Live | undefined {
  const convert = useConversion();
  return useCallback(
    (signal, live) => {
      if (!live) {
        return undefined;
      }
      const { unit, factor } = convert(signal, live.unit);
      return { value: live.value === null ? null : live.value * factor, unit };
    },
    [convert],
  );
}

/// Live values of signals, rendered at most every `interval` milliseconds.
export function useSignals(names: readonly string[], interval = 150): (name: string) => Live | undefined {
  const { hub } = useWorld();
  const [, render] = useState({});
  const key = names.join("\n");
  const last = useRef(0);
  useEffect(() => {
    const list = key === "" ? [] : key.split("\n");
    if (list.length === 0) {
      return undefined;
    }
    let timer: ReturnType<typeof setTimeout> | undefined;
    const show = () => {
      timer = undefined;
      last.current = performance.now();
      render({});
    };
    const stop = hub.watch(list, () => {
      const wait = last.current + interval - performance.now();
      if (wait <= 0) {
        show();
      } else {
        timer ??= setTimeout(show, wait);
      }
    });
    return () => {
      clearTimeout(timer);
      stop();
    };
  }, [hub, key, interval]);
  return useCallback((name: string) => hub.value(name), [hub]);
}

/// Whether a media query holds, now and whenever that changes.
export function useMedia(query: string): boolean {
  const list = useMemo(() => matchMedia(query), [query]);
  const [holds, setHolds] = useState(list.matches);
  useEffect(() => {
    const changed = () => setHolds(list.matches);
    changed();
    list.addEventListener("change", changed);
    return () => list.removeEventListener("change", changed);
  }, [list]);
  return holds;
}

/// The width of an element as it is laid out.
export function useWidth(): [(element: HTMLElement | null) => void, number] {
  const [width, setWidth] = useState(0);
  const observer = useMemo(
    () =>
      new ResizeObserver((entries) => {
        const found = entries[0];
        if (found) {
          setWidth(Math.floor(found.contentRect.width));
        }
      }),
    [],
  );
  const attach = useCallback(
    (element: HTMLElement | null) => {
      observer.disconnect();
      if (element) {
        observer.observe(element);
        setWidth(Math.floor(element.clientWidth));
      }
    },
    [observer],
  );
  return [attach, width];
}

/// A write under way and what became of it.
export interface Action {
  readonly busy: boolean;
  readonly error: string;
  readonly run: (write: () => Promise<unknown>) => Promise<boolean>;
  readonly clear: () => void;
}

export function problemText(error: unknown): string {
  if (error instanceof ApiError) {
    const { abort_code: code, abort_text: text } = error.problem;
    const abort = code && `${code.replace(/^0x/, "")}h${text ? `: ${text}` : ""}`;
    return abort ? t("{problem} (abort code {code})", { problem: error.message, code: abort }) : error.message;
  }
  return String(error);
}

/// What a write that failed says to a person, who is asked for the token if that is what it lacks.
export function refusalText(error: unknown): string {
  if (error instanceof ApiError && error.unauthorised) {
    document.dispatchEvent(new CustomEvent("tokenwanted"));
  }
  return problemText(error);
}

export function useAction(): Action {
  const { store } = useWorld();
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState("");
  const run = useCallback(
    async (write: () => Promise<unknown>) => {
      setBusy(true);
      try {
        await write();
        setError("");
        return true;
      } catch (wrong) {
        setError(refusalText(wrong));
        return false;
      } finally {
        setBusy(false);
        store.refresh();
      }
    },
    [store],
  );
  const clear = useCallback(() => setError(""), []);
  return { busy, error, run, clear };
}
