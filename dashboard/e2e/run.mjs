// The dashboard in a browser, against a real rack:
//
//   node e2e/run.mjs [--stator PROGRAM] [--out FOLDER] [--only TEXT]
//
// Screenshots of every view, at both widths and in both themes, go to FOLDER.
import { mkdir, mkdtemp, readFile, rm } from "node:fs/promises";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { parseArgs } from "node:util";

import { chromium } from "playwright-core";

import { serveFixtures } from "./fixture_server.mjs";
import { freeTcpPort, Rack, repository } from "./rack.mjs";
import { behaviours, views } from "./views.mjs";

const { values: options } = parseArgs({
  options: {
    stator: { type: "string", default: join(repository, "build/release/src/cli/stator") },
    out: { type: "string", default: join(repository, "build/dashboard-screenshots") },
    only: { type: "string", default: "" },
    chromium: { type: "string", default: "/usr/bin/chromium" },
  },
});

const kSizes = [
  { width: 1280, height: 800 },
  { width: 1920, height: 1080 },
];
const kThemes = ["light", "dark"];

let passed = 0;
const failures = [];
async function check(name, test) {
  if (!name.includes(options.only)) {
    return;
  }
  const start = performance.now();
  try {
    await test();
    ++passed;
    console.log(`ok      ${name} (${Math.round(performance.now() - start)} ms)`);
  } catch (error) {
    failures.push(name);
    console.log(`FAILED  ${name}\n${error.stack ?? error}`);
  }
}

await mkdir(options.out, { recursive: true });
const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const rack = await Rack.lay(options.stator);
const profile = await mkdtemp(join(tmpdir(), "stator-chromium-"));
let context;
let fixtures;
let master;
try {
  const link = await rack.start();
  const proxyPort = await freeTcpPort();
  fixtures = await serveFixtures(rack.origin, proxyPort);
  if (fixtures.missing.length > 0) {
    console.log(`from fixtures, since the server lacks them: ${fixtures.missing.join(", ")}`);
  }
  context = await chromium.launchPersistentContext(profile, {
    executablePath: options.chromium,
    headless: true,
    viewport: kSizes[0],
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
  context.setDefaultTimeout(30000);
  const problems = [];
  const token = new URL(link).hash;
  const open = async (base, view) => {
    const page = await context.newPage();
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) {
        problems.push(`${message.text()} ${message.location().url}`);
      }
    });
    page.on("pageerror", (error) => problems.push(error.stack ?? String(error)));
    await page.goto(`${base}/${token}&view=${encodeURIComponent(view)}`);
    return page;
  };
  const quiet = (allowed = []) => {
    const bad = problems.splice(0).filter((text) => !allowed.some((part) => text.includes(part)));
    if (bad.length > 0) {
      throw new Error(`the console says:\n${bad.join("\n")}`);
    }
  };
  const proxy = `http://127.0.0.1:${proxyPort}`;
  master = rack.move(60);
  await new Promise((done) => setTimeout(done, 1500));

  for (const view of views) {
    await check(`view ${view.name}`, async () => {
      const page = await open(fixtures.missing.some((route) => view.needs?.includes(route)) ? proxy : rack.origin, view.path);
      try {
        await page.emulateMedia({ colorScheme: kThemes[0] });
        await view.ready(page);
        for (const theme of kThemes) {
          await page.emulateMedia({ colorScheme: theme });
          for (const size of kSizes) {
            await page.setViewportSize(size);
            await page.waitForTimeout(150);
            await page.screenshot({ path: join(options.out, `${view.name}-${size.width}-${theme}.png`) });
            const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
            if (wide > 0) {
              throw new Error(`${wide} pixels too wide at ${size.width}`);
            }
          }
          await page.setViewportSize(kSizes[0]);
          // Through the debugger, since the page's policy lets it run nothing else.
          const session = await context.newCDPSession(page);
          await session.send("Runtime.evaluate", { expression: axe });
          const { result } = await session.send("Runtime.evaluate", {
            expression: `axe.run(document, { resultTypes: ["violations"] }).then((r) => JSON.stringify(r.violations.map((v) =>
              v.id + ": " + v.help + "\\n  " + v.nodes.slice(0, 3).map((n) => n.html.slice(0, 160) + " " + (n.any[0]?.message ?? "")).join("\\n  "))))`,
            awaitPromise: true,
          });
          const violations = JSON.parse(result.value);
          if (violations.length > 0) {
            throw new Error(`axe, ${theme}:\n${violations.join("\n")}`);
          }
          await session.detach();
        }
        quiet();
      } finally {
        await page.close();
        problems.splice(0);
      }
    });
  }
  await master.stop();
  for (const behaviour of behaviours) {
    await check(behaviour.name, async () => {
      const base = fixtures.missing.some((route) => behaviour.needs?.includes(route)) ? proxy : rack.origin;
      const page = await open(base, behaviour.path ?? "/rack");
      await page.setViewportSize(kSizes[0]);
      try {
        await behaviour.test(page, { rack, link, origin: base, out: options.out });
        quiet(behaviour.allowed);
      } finally {
        await page.close();
        problems.splice(0);
      }
    });
  }
} finally {
  await context?.close();
  fixtures?.close();
  await master?.stop();
  if (failures.length > 0) {
    console.log(`what stator run said at last:\n${rack.output}`);
  }
  await rack.clean();
  await rm(profile, { recursive: true, force: true });
}
console.log(`\n${passed} passed, ${failures.length} failed`);
process.exitCode = failures.length > 0 || passed === 0 ? 1 : 0;
