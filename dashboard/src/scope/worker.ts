// Receives and decodes the stream beside the page, so that drawing never delays receiving.
import type { SignalMessage } from "../api_types";
import { closeSocket } from "../close_socket";
import { decodeBatch } from "./core/batch";
import { Outbox } from "./core/outbox";
import type { FromWorker, ToWorker } from "./worker_messages";

interface Scope {
  postMessage(message: FromWorker, transfer: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
}
const page = globalThis as unknown as Scope;

/// Half a second or more of ten signals at 20 kHz under way to the page, and nine more seconds here.
const kInFlight = 64;
const kMostBytes = 16 * 2 ** 20;

let socket: WebSocket | null = null;
let outbox = makeOutbox();

function makeOutbox(): Outbox<FromWorker> {
  return new Outbox<FromWorker>(
    (message) => {
      if (message.kind === "samples") {
        page.postMessage({ ...message, droppedByPage: outbox.dropped }, [message.times.buffer]);
      } else {
        page.postMessage(message, []);
      }
    },
    kInFlight,
    kMostBytes,
  );
}

function takeBinary(data: ArrayBuffer): void {
  const batch = decodeBatch(data);
  outbox.push(
    { kind: "samples", rows: batch.rows, times: batch.times, columns: batch.columns, droppedByServer: batch.dropped, droppedByPage: 0 },
    batch.rows,
    data.byteLength,
  );
}

function takeText(text: string): void {
  const message = JSON.parse(text) as SignalMessage;
  switch (message.type) {
    case "subscribed":
      outbox.push({ kind: "subscribed", message }, 0, text.length);
      break;
    case "events":
      outbox.push({ kind: "events", events: message.events }, 0, text.length);
      break;
    case "problem":
      outbox.push({ kind: "problem", problem: message.problem }, 0, text.length);
      break;
    case "samples":
      break; // binary ones were asked for
  }
}

function open(url: string, protocols: readonly string[]): void {
  closeSocket(socket);
  outbox = makeOutbox();
  const opened = new WebSocket(url, [...protocols]);
  socket = opened;
  opened.binaryType = "arraybuffer";
  opened.onopen = () => outbox.push({ kind: "opened" }, 0, 0);
  opened.onclose = (event) => {
    if (socket === opened) {
      socket = null;
      outbox.push({ kind: "closed", reason: event.reason }, 0, 0);
    }
  };
  opened.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
    if (socket !== opened) {
      return;
    }
    try {
      if (typeof event.data === "string") {
        takeText(event.data);
      } else {
        takeBinary(event.data);
      }
    } catch (error) {
      outbox.push({ kind: "problem", problem: { detail: (error as Error).message } }, 0, 0);
    }
  };
}

page.onmessage = ({ data }) => {
  switch (data.kind) {
    case "open":
      open(data.url, data.protocols);
      break;
    case "send":
      socket?.send(data.text);
      break;
    case "taken":
      outbox.taken(data.messages);
      break;
    case "close":
      closeSocket(socket);
      socket = null;
      break;
  }
};
