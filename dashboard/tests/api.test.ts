import { describe, expect, it } from "vitest";

import lock from "../package-lock.json?raw";
import { Api, ApiError } from "../src/api";

function fake(status: number, body: unknown) {
  const calls: [string, RequestInit][] = [];
  const kept = new Map<string, string>();
  const api = new Api({
    fetch: ((path: string, init: RequestInit) => {
      calls.push([path, init]);
      return status === 0 ? Promise.reject(new TypeError("refused")) : Promise.resolve(new Response(JSON.stringify(body), { status }));
    }) as typeof fetch,
    storage: {
      getItem: (key) => kept.get(key) ?? null,
      setItem: (key, value) => void kept.set(key, value),
      removeItem: (key) => void kept.delete(key),
    },
    location: { origin: "http://127.0.0.1:8080" },
  });
  return { api, calls };
}

describe("the client", () => {
  it("sends the token once there is one", async () => {
    const { api, calls } = fake(200, { time_ns: 1 });
    await api.get("/api/v1/rack");
    api.token = "secret";
    await api.send("PUT", "/api/v1/inputs/x", { value: 1 });
    expect((calls[0]?.[1].headers as Record<string, string>)["Authorization"]).toBeUndefined();
    expect(calls[1]?.[1]).toMatchObject({
      method: "PUT",
      body: '{"value":1}',
      headers: { Authorization: "Bearer secret", "Content-Type": "application/json" },
    });
  });
  it("tells what the server refused and why", async () => {
    const { api } = fake(422, { title: "Unprocessable Content", detail: "out of range", abort_code: "0x06090030" });
    const error = await api.get("/x").catch((wrong: unknown) => wrong);
    expect(error).toBeInstanceOf(ApiError);
    expect(error).toMatchObject({ status: 422, message: "out of range", problem: { abort_code: "0x06090030" } });
  });
  it("knows a server that does not answer", async () => {
    const { api } = fake(0, null);
    await expect(api.get("/x")).rejects.toMatchObject({ status: 0, unreachable: true });
  });
});

describe("the lock file", () => {
  it("names no hosts", () => {
    expect(lock).not.toMatch(/https?:/);
  });
});
