// A real rack to look at: `stator run` in a process of its own, on ports that are free.
import { spawn } from "node:child_process";
import { createSocket } from "node:dgram";
import { cp, mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";

const here = dirname(new URL(import.meta.url).pathname);
export const repository = resolve(here, "../..");

/// What a browser says of a rack that is not there for a moment.
export const kRackGone = [
  "ERR_CONNECTION_REFUSED",
  "ERR_CONNECTION_RESET",
  "ERR_EMPTY_RESPONSE",
  "WebSocket connection",
  "Failed to load resource",
];

// Below the ports that Linux gives connections of its own choice (from 32768 on), of which one that a browser closes or opens
// could take the rack's while the rack is restarted. Each worker looks among its own.
const kFirstPort = 20_000;
const kPortsOfWorker = 1_000;

/// True if somebody could have the port now. Both kinds of sockets give "listening" or "error".
async function isFree(socket, bind) {
  const free = await new Promise((done) => {
    socket.once("error", () => done(false));
    socket.once("listening", () => done(true));
    bind(socket);
  });
  if (free) {
    await new Promise((done) => socket.close(done));
  }
  return free;
}

/// A port that is free both for UDP and for TCP, of those of a worker; which of them is drawn, as other checkouts test as well.
async function freePort(worker) {
  for (let i = 0; i < 100; ++i) {
    const port = kFirstPort + worker * kPortsOfWorker + Math.floor(Math.random() * kPortsOfWorker);
    if (
      (await isFree(createSocket("udp4"), (socket) => socket.bind(port, "127.0.0.1"))) &&
      (await isFree(createServer(), (server) => server.listen(port, "127.0.0.1")))
    ) {
      return port;
    }
  }
  throw new Error(`no port of worker ${worker} is free`);
}

/// A child process that was started and has not ended: the only kind to send signals to and wait for.
/// (kill() of one that could not be started signals Node's own process group.)
export function runs(child) {
  return child?.pid !== undefined && child.exitCode === null && child.signalCode === null;
}

export class Rack {
  /// Lays a copy of racks/five-devices.toml out whose links nobody else has, neither another worker of Playwright.
  static async lay(stator, worker) {
    const rack = new Rack();
    rack.stator = stator;
    rack.starts = 0;
    rack.folder = await mkdtemp(join(tmpdir(), "stator-e2e-"));
    rack.udp = await freePort(worker);
    rack.http = rack.udp; // of another protocol
    const text = await readFile(join(repository, "racks/five-devices.toml"), "utf8");
    rack.file = join(rack.folder, "racks/rack.toml");
    await mkdir(dirname(rack.file));
    await cp(join(repository, "examples"), join(rack.folder, "examples"), { recursive: true });
    await writeFile(
      rack.file,
      text.replaceAll("/tmp/stator-", `${rack.folder}/`).replace('"udp:127.0.0.1"', `"udp:127.0.0.1:${rack.udp}"`),
    );
    return rack;
  }

  get origin() {
    return `http://127.0.0.1:${this.http}`;
  }

  /// Starts it, recorded or not; `link` is the one to the dashboard that it prints.
  async start({ recorded = true } = {}) {
    const recording = join(this.folder, `run${this.starts === 0 ? "" : `-again${this.starts}`}.stator`);
    ++this.starts;
    this.process = spawn(this.stator, ["run", this.file, "--http", String(this.http), ...(recorded ? ["--record", recording] : [])], {
      cwd: this.folder,
      stdio: ["ignore", "pipe", "pipe"],
    });
    this.output = "";
    let failed = "";
    this.process.stdout.on("data", (data) => (this.output += data));
    this.process.stderr.on("data", (data) => (this.output += data));
    this.process.on("error", (error) => (failed = `${this.stator} does not start: ${error.message}`));
    this.process.on("exit", (code) => (failed = `stator run ended with ${code}`));
    for (let i = 0; i < 1200; ++i) {
      const link = /dashboard: (\S+)/.exec(this.output);
      if (link && this.output.includes("Running")) {
        this.link = link[1];
        return;
      }
      if (failed !== "") {
        break;
      }
      await new Promise((done) => setTimeout(done, 50));
    }
    throw new Error(`${failed || "stator run does not start"}:\n${this.output}`);
  }

  async stop() {
    const { process } = this;
    if (runs(process)) {
      const ended = new Promise((done) => process.once("exit", done));
      process.kill("SIGTERM");
      await ended;
    }
  }

  /// A master that turns the first axis for a while.
  move(revolutions) {
    let ended = false;
    let master;
    let way = revolutions;
    const next = () => {
      master = spawn(this.stator, ["move", "--link", `udp:127.0.0.1:${this.udp}`, "--timeout", "1s", "--revolutions", String(way)], {
        stdio: "ignore",
      });
      way = -way;
      master.on("error", (error) => {
        throw new Error(`${this.stator} does not start: ${error.message}`);
      });
      master.once("exit", () => {
        if (!ended) {
          setTimeout(() => ended || next(), 100);
        }
      });
    };
    next();
    return {
      stop: async () => {
        ended = true;
        if (runs(master)) {
          const ended = new Promise((done) => master.once("exit", done));
          master.kill("SIGTERM");
          await ended;
        }
      },
    };
  }

  async clean() {
    await this.stop();
    await rm(this.folder, { recursive: true, force: true });
  }
}
