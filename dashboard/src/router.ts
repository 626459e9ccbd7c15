// Addresses of views: "#/device/gantry/objects?search=6041". The fragment keeps them off the server.

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
  return { view: view || "rack", parts, query: new Map(new URLSearchParams(query)) };
}

export function href(view: string, parts: readonly string[] = [], query: Record<string, string> = {}): string {
  const path = [view, ...parts].map(encodeURIComponent).join("/");
  const search = new URLSearchParams(query).toString();
  return `#/${path}${search === "" ? "" : `?${search}`}`;
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
