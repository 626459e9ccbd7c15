// Addresses of views: "#/device/gantry/objects?search=6041". The fragment keeps them off the server. The unit of positions and
// velocities stands in them too where it is not the usual one, and is no choice of a view.

import { useCallback, useEffect, useState } from "preact/hooks";

import { kUsualUnit, motionUnit, rememberUnit, unitNamed, type MotionUnit } from "./motion_units";

const kUnitsName = "units";

export interface Route {
  readonly view: string;
  readonly parts: readonly string[];
  readonly query: ReadonlyMap<string, string>;
}

function decode(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

export function parseRoute(hash: string): Route {
  const text = hash.replace(/^#\/?/, "");
  const [path = "", query = ""] = text.split("?", 2);
  const [view = "", ...parts] = path.split("/").map(decode);
  const choices = new Map(new URLSearchParams(query));
  choices.delete(kUnitsName);
  return { view: view || "rack", parts, query: choices };
}

export function href(view: string, parts: readonly string[] = [], query: Record<string, string> = {}): string {
  const path = [view, ...parts].map(encodeURIComponent).join("/");
  const { value: unit } = motionUnit; // links follow it
  const search = new URLSearchParams(unit === kUsualUnit ? query : { ...query, [kUnitsName]: unit }).toString();
  return `#/${path}${search === "" ? "" : `?${search}`}`;
}

/// Writes the address anew, with the present unit.
function renewAddress(): void {
  const { view, parts, query } = parseRoute(location.hash);
  history.replaceState(history.state, "", href(view, parts, Object.fromEntries(query)));
}

/// Shows positions and velocities in `unit` from now on, here and at the next visit.
export function chooseUnit(unit: MotionUnit): void {
  rememberUnit(unit);
  renewAddress();
}

/// Takes the unit that the address says; says it there if it does not.
export function followUnit(): void {
  const said = unitNamed(new URLSearchParams(location.hash.split("?", 2)[1] ?? "").get(kUnitsName));
  if (said !== null) {
    motionUnit.value = said;
  } else if (motionUnit.value !== kUsualUnit) {
    renewAddress();
  }
}

/// A token that came with the address ("#token=…", perhaps with a view behind it: "#token=…&view=/events"),
/// and the fragment without it. Null: there is none.
export function takeToken(hash: string): { token: string; rest: string } | null {
  const found = /^#token=([^&]*)(?:&view=(.*))?$/.exec(hash);
  if (!found) {
    return null;
  }
  return { token: decode(found[1] ?? ""), rest: found[2] ? `#${decode(found[2])}` : "" };
}

/// The choices of the view in the address, and a change of some of them that leaves the view in its place; an empty text takes
/// a choice out. Reloading the page, or opening the address elsewhere, brings them back.
export function useQuery(): [ReadonlyMap<string, string>, (changes: Readonly<Record<string, string>>) => void] {
  const [query, setQuery] = useState(() => parseRoute(location.hash).query);
  useEffect(() => {
    const changed = () => setQuery(parseRoute(location.hash).query);
    window.addEventListener("hashchange", changed);
    return () => window.removeEventListener("hashchange", changed);
  }, []);
  const change = useCallback((changes: Readonly<Record<string, string>>) => {
    const route = parseRoute(location.hash);
    const next = Object.fromEntries(Object.entries({ ...Object.fromEntries(route.query), ...changes }).filter(([, value]) => value !== ""));
    history.replaceState(null, "", href(route.view, route.parts, next));
    setQuery(new Map(Object.entries(next)));
  }, []);
  return [query, change];
}

/// One of them, and a change of it.
export function useChoice(name: string): [string, (value: string) => void] {
  const [query, change] = useQuery();
  return [query.get(name) ?? "", useCallback((value: string) => change({ [name]: value }), [change, name])];
}
