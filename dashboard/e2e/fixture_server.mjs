// Stands before a real rack and answers what its server does not offer yet. All else passes through.
import { createHash } from "node:crypto";
import { createServer, request } from "node:http";
import { connect } from "node:net";

import { fixture, frames, routes } from "./fixtures.mjs";

function frame(text) {
  const payload = Buffer.from(text);
  const head = payload.length < 126 ? Buffer.from([0x81, payload.length]) : Buffer.from([0x81, 126, payload.length >> 8, payload.length & 255]);
  return Buffer.concat([head, payload]);
}

export async function serveFixtures(rack, listenAt) {
  const openapi = await (await fetch(`${rack}/openapi.json`)).json();
  const missing = routes.filter((route) => !(route in openapi.paths));
  const is = (path) => missing.some((route) => new RegExp(`^${route.replace(/\{\w+\}/g, "[^/]+")}$`).test(path));
  const target = new URL(rack);
  const headersFor = (incoming) => {
    const headers = { ...incoming.headers, host: target.host };
    delete headers.origin;
    return headers;
  };
  const server = createServer((incoming, outgoing) => {
    const path = new URL(incoming.url, rack).pathname;
    const send = (value) => {
      outgoing.writeHead(200, { "Content-Type": "application/json", "Cache-Control": "no-store" });
      outgoing.end(JSON.stringify(value));
    };
    if (path === "/openapi.json") {
      send({ ...openapi, paths: { ...openapi.paths, ...Object.fromEntries(missing.map((route) => [route, {}])) } });
    } else if (is(path)) {
      let text = "";
      incoming.on("data", (data) => (text += data));
      incoming.on("end", () => send(fixture(incoming.method, path, text === "" ? null : JSON.parse(text))));
    } else {
      const passed = request(
        { host: target.hostname, port: target.port, path: incoming.url, method: incoming.method, headers: headersFor(incoming) },
        (answer) => {
          outgoing.writeHead(answer.statusCode, answer.headers);
          answer.pipe(outgoing);
        },
      );
      passed.on("error", () => outgoing.destroy());
      incoming.pipe(passed);
    }
  });
  server.on("upgrade", (incoming, socket, head) => {
    socket.on("error", () => socket.destroy());
    if (is(new URL(incoming.url, rack).pathname)) {
      const accept = createHash("sha1").update(`${incoming.headers["sec-websocket-key"]}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");
      socket.write(
        `HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\nSec-WebSocket-Protocol: stator.traffic.v1\r\n\r\n`,
      );
      const timer = setInterval(() => socket.write(frame(JSON.stringify({ type: "frames", dropped: 0, frames: frames() }))), 100);
      socket.on("close", () => clearInterval(timer));
      socket.on("data", () => {});
      return;
    }
    const passed = connect(Number(target.port), target.hostname, () => {
      const headers = Object.entries(headersFor(incoming)).map(([name, value]) => `${name}: ${value}`);
      passed.write(`GET ${incoming.url} HTTP/1.1\r\n${headers.join("\r\n")}\r\n\r\n`);
      passed.write(head);
      passed.pipe(socket);
      socket.pipe(passed);
    });
    passed.on("error", () => socket.destroy());
    socket.on("close", () => passed.destroy());
    passed.on("close", () => socket.destroy());
  });
  await new Promise((done) => server.listen(listenAt, "127.0.0.1", done));
  return { missing, close: () => (server.closeAllConnections(), server.close()) };
}
