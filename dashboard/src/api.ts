// The client of the server's HTTP interface. The types of answers are made from docs/openapi.json: npm run types.
import type { Problem } from "./api_types";
import { t } from "./language";

export type * from "./api_types";

const kTokenKey = "stator.token";

/// A request that was refused or did not come through. `status` 0: the server cannot be reached.
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Partial<Problem>,
  ) {
    super(problem.detail ?? problem.title ?? `HTTP ${status}`);
    this.name = "ApiError";
  }
  get unreachable(): boolean {
    return this.status === 0;
  }
  get unauthorised(): boolean {
    return this.status === 401;
  }
  get notFound(): boolean {
    return this.status === 404;
  }
}

export type Method = "GET" | "PUT" | "POST" | "DELETE";

export interface RequestOptions {
  readonly signal?: AbortSignal;
  readonly body?: unknown;
  readonly accept?: string;
}

/// A write that the server took.
export interface Written {
  readonly method: Method;
  readonly path: string;
  readonly body: unknown;
  readonly answer: unknown;
}

export interface Environment {
  readonly fetch: typeof fetch;
  readonly storage: Pick<Storage, "getItem" | "setItem" | "removeItem">;
  readonly location: { readonly origin: string };
}

function browser(): Environment {
  return {
    fetch: (input, init) => window.fetch(input, init),
    storage: window.sessionStorage,
    location: window.location,
  };
}

async function problemOf(response: Response): Promise<Partial<Problem>> {
  try {
    return (await response.json()) as Problem;
  } catch {
    return { title: response.statusText || `HTTP ${response.status}`, status: response.status };
  }
}

export class Api {
  private readonly environment: Environment;
  private readonly tokenListeners = new Set<() => void>();
  private readonly writtenListeners = new Set<(written: Written) => void>();

  constructor(environment?: Environment) {
    this.environment = environment ?? browser();
  }

  /// The token for writes; kept as long as the tab. Empty: none is known.
  get token(): string {
    return this.environment.storage.getItem(kTokenKey) ?? "";
  }
  set token(value: string) {
    if (value === "") {
      this.environment.storage.removeItem(kTokenKey);
    } else {
      this.environment.storage.setItem(kTokenKey, value);
    }
    for (const listener of this.tokenListeners) {
      listener();
    }
  }
  onToken(listener: () => void): () => void {
    this.tokenListeners.add(listener);
    return () => this.tokenListeners.delete(listener);
  }

  /// `listener` is told of each write that the server took.
  onWritten(listener: (written: Written) => void): void {
    this.writtenListeners.add(listener);
  }

  async fetch(method: Method, path: string, options: RequestOptions = {}): Promise<Response> {
    const headers: Record<string, string> = { Accept: options.accept ?? "application/json" };
    if (this.token !== "") {
      headers["Authorization"] = `Bearer ${this.token}`;
    }
    const init: RequestInit = { method, headers, cache: "no-store" };
    if (method !== "GET") {
      headers["Content-Type"] = "application/json"; // the server asks for it with every write
    }
    if (options.body !== undefined) {
      init.body = JSON.stringify(options.body);
    }
    if (options.signal) {
      init.signal = options.signal;
    }
    let response: Response;
    try {
      response = await this.environment.fetch(path, init);
    } catch (error) {
      if (error instanceof DOMException && error.name === "AbortError") {
        throw error;
      }
      throw new ApiError(0, { title: t("No connection"), detail: t("the rack cannot be reached") });
    }
    if (!response.ok) {
      throw new ApiError(response.status, await problemOf(response));
    }
    return response;
  }

  async get<T>(path: string, options: RequestOptions = {}): Promise<T> {
    return (await (await this.fetch("GET", path, options)).json()) as T;
  }

  async text(path: string, options: RequestOptions = {}): Promise<string> {
    return (await this.fetch("GET", path, { accept: "*/*", ...options })).text();
  }

  async send<T>(method: Exclude<Method, "GET">, path: string, body?: unknown): Promise<T> {
    const response = await this.fetch(method, path, body === undefined ? {} : { body });
    const text = await response.text();
    const answer = (text === "" ? {} : JSON.parse(text)) as T;
    for (const listener of this.writtenListeners) {
      listener({ method, path, body, answer });
    }
    return answer;
  }

  /// Opens a WebSocket. Browsers cannot add an Authorization to one, so the token is offered as a
  /// subprotocol beside the streams'.
  socket(path: string): WebSocket {
    const protocols = ["stator.signals.v1", "stator.traffic.v1"];
    if (this.token !== "") {
      protocols.push(`token.${this.token}`);
    }
    const base = this.environment.location.origin.replace(/^http/, "ws");
    return new WebSocket(base + path, protocols);
  }
}

/// A segment of a path.
export function segment(text: string): string {
  return encodeURIComponent(text);
}
