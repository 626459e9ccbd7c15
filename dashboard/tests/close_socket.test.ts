import { beforeAll, describe, expect, it, vi } from "vitest";

import { closeSocket } from "../src/close_socket";

beforeAll(() => vi.stubGlobal("WebSocket", { CONNECTING: 0, OPEN: 1 }));

function socketIn(readyState: number) {
  const close = vi.fn();
  return { readyState, close, onopen: null as (() => void) | null };
}
const given = (socket: ReturnType<typeof socketIn>) => closeSocket(socket as unknown as WebSocket);

describe("closing a socket", () => {
  it("is done at once where it is connected", () => {
    const socket = socketIn(1);
    given(socket);
    expect(socket.close).toHaveBeenCalledOnce();
  });

  it("waits for one that is still connecting", () => {
    const socket = socketIn(0);
    given(socket);
    expect(socket.close).not.toHaveBeenCalled();
    socket.onopen?.();
    expect(socket.close).toHaveBeenCalledOnce();
  });

  it("does nothing where there is none", () => {
    expect(() => closeSocket(null)).not.toThrow();
  });
});
