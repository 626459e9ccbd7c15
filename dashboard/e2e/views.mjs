// What is looked at, and what is done there as a person would.
import assert from "node:assert/strict";

import * as scope from "./scope.mjs";

const heading = (name) => async (page) => page.getByRole("heading", { level: 1, name, exact: true }).waitFor();
const text = (name, found) => async (page) => {
  await heading(name)(page);
  await page.getByText(found).first().waitFor();
  await page.waitForTimeout(600);
};

const kPanel = "/api/v1/devices/{device}/panel";

export const views = [
  { name: "rack", path: "/rack", needs: ["/api/v1/wiring", kPanel], ready: text("Rack", "Networks") },
  { name: "gantry", path: "/device/gantry", needs: [kPanel, "/api/v1/state-machines"], ready: text("gantry", "6041h") },
  { name: "servo", path: "/device/servo", needs: [kPanel, "/api/v1/state-machines"], ready: text("servo", "6041h") },
  { name: "spindle", path: "/device/spindle", needs: [kPanel, "/api/v1/state-machines"], ready: text("spindle", "6041h") },
  { name: "io", path: "/device/io", needs: [kPanel], ready: text("io", "Inputs") },
  { name: "feeder", path: "/device/feeder", needs: [kPanel], ready: text("feeder", "Shaft speed") },
  { name: "objects", path: "/device/gantry/objects", ready: text("gantry", "Device type") },
  { name: "signals", path: "/device/gantry/signals", ready: text("gantry", "axis0.torque") },
  {
    name: "program",
    path: "/device/feeder/program",
    needs: [kPanel, "/api/v1/devices/{device}/program"],
    ready: text("feeder", "MVP ABS"),
  },
  { name: "events", path: "/events", ready: text("Events", "spindle") },
  { name: "traffic", path: "/traffic", needs: ["/api/v1/traffic"], ready: text("Traffic", /LRW|FPRD|BRD|LWR|LRD/) },
  { name: "faults", path: "/faults", needs: ["/api/v1/faults/kinds", "/api/v1/faults"], ready: text("Faults", "Kinds") },
  { name: "recording", path: "/recording", needs: ["/api/v1/recording", "/api/v1/snapshots"], ready: heading("Recording") },
  { name: "scope", path: "/scope", ready: scope.ready },
];

const put = (page, address) => page.getByRole("button", { name: `Write ${address}`, exact: true });

/// What a browser says of a rack that is not there for a moment.
const kRackGone = ["ERR_CONNECTION_REFUSED", "ERR_CONNECTION_RESET", "ERR_EMPTY_RESPONSE", "WebSocket connection", "Failed to load resource"];

export const behaviours = [
  {
    name: "the token leaves the address bar and stays in the tab",
    test: async (page, { link }) => {
      await heading("Rack")(page);
      assert.ok(!page.url().includes("token"), page.url());
      const kept = await page.evaluate(() => sessionStorage.getItem("stator.token"));
      assert.equal(`#token=${kept}`, new URL(link).hash);
    },
  },
  {
    name: "keys alone lead from view to view",
    test: async (page) => {
      await heading("Rack")(page);
      await page.keyboard.press("Tab");
      assert.equal(await page.evaluate(() => document.activeElement?.textContent?.trim()), "Skip to the content");
      for (let i = 0; i < 12; ++i) {
        await page.keyboard.press("Tab");
        if ((await page.evaluate(() => document.activeElement?.textContent?.trim())) === "gantry") {
          break;
        }
      }
      const ring = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
      assert.equal(ring, "solid");
      await page.keyboard.press("Enter");
      await heading("gantry")(page);
    },
  },
  {
    name: "shafts turn as the motors do",
    test: async (page) => {
      const shaft = page.locator("a.card", { hasText: "feeder" }).locator(".shaft g").first();
      const seen = new Set();
      for (let i = 0; i < 40 && seen.size < 3; ++i) {
        await page.waitForTimeout(50);
        seen.add(await shaft.getAttribute("transform"));
      }
      assert.ok(seen.size >= 3, [...seen].join(", "));
    },
  },
  {
    name: "the load is set with a slider and comes back as a signal",
    path: "/device/gantry",
    test: async (page, { origin }) => {
      const slider = page.getByRole("slider", { name: "load torque" }).first();
      await slider.focus();
      for (let i = 0; i < 5; ++i) {
        await page.keyboard.press("ArrowRight");
      }
      const shown = Number(await page.getByRole("textbox", { name: "load torque, exact" }).first().inputValue());
      assert.ok(shown > 0);
      for (let i = 0; i < 40; ++i) {
        const answer = await (await fetch(`${origin}/api/v1/signals?names=gantry.axis0.load_torque`)).json();
        if (Math.abs(answer.signals[0].value - shown) < 1e-9) {
          return;
        }
        await page.waitForTimeout(50);
      }
      assert.fail(`the load did not become ${shown} N m`);
    },
  },
  {
    name: "a refused write tells why",
    path: "/device/gantry/objects?search=6060",
    allowed: ["422"],
    test: async (page) => {
      await put(page, "6060h:00").click();
      const field = page.getByLabel(/New value of 6060h:00/);
      await field.fill("99");
      await page.getByText(/is possible/).waitFor();
      await field.fill("2"); // in the range, but not among the modes
      await field.press("Enter");
      await page.getByText(/06090030h/).waitFor();
      await field.fill("1");
      await field.press("Enter");
      await page.getByText("Written.").waitFor();
      await field.press("Escape");
      assert.equal(await field.count(), 0);
    },
  },
  {
    name: "values of the dictionary are refreshed while they are visible",
    path: "/device/gantry/objects?search=607A:00",
    test: async (page, { origin, link }) => {
      const row = page.locator("tr", { hasText: "607Ah:00" });
      await row.locator("td.value", { hasText: /^-?\d+$/ }).waitFor();
      const answer = await fetch(`${origin}/api/v1/devices/gantry/objects/607A/00`, {
        method: "PUT",
        headers: { Authorization: `Bearer ${new URL(link).hash.slice(7)}`, "Content-Type": "application/json" },
        body: '{"value": 4711}',
      });
      assert.equal(answer.status, 200, await answer.text());
      await row.locator("td.value", { hasText: "4711" }).waitFor();
    },
  },
  {
    name: "without the right token a write asks for one",
    path: "/device/gantry",
    allowed: ["401"],
    test: async (page) => {
      await page.getByText("Inputs").waitFor();
      await page.evaluate(() => sessionStorage.setItem("stator.token", "wrong"));
      await page.getByRole("switch", { name: "left switch" }).first().focus();
      await page.keyboard.press("Space");
      const dialog = page.getByRole("dialog");
      await dialog.waitFor();
      await page.keyboard.press("Escape");
      await dialog.waitFor({ state: "hidden" });
    },
  },
  {
    name: "events are found by words and kinds",
    path: "/events",
    test: async (page) => {
      await page.getByRole("searchbox").fill("pre-operational spindle");
      await page.getByText(/NMT state of node/).first().waitFor();
      await page.getByRole("searchbox").fill("no such words");
      await page.getByText("No event fits the filter.").waitFor();
    },
  },
  {
    name: "a fault is put and cleared",
    path: "/faults",
    needs: ["/api/v1/faults/kinds", "/api/v1/faults", "/api/v1/wiring"],
    test: async (page) => {
      await page.getByRole("region", { name: "Kinds of faults" }).getByRole("button").first().click();
      await page.getByRole("button", { name: "Put it there" }).click();
      await page.getByRole("button", { name: /Clear fault/ }).first().waitFor();
      await page.getByRole("button", { name: "Clear all" }).click();
      await page.getByText("No fault is armed or active.").waitFor();
    },
  },
  {
    name: "traffic can be stopped and looked into",
    path: "/traffic",
    needs: ["/api/v1/traffic"],
    test: async (page, { rack }) => {
      const master = rack.move(2);
      try {
        await page.locator("button.plain").first().waitFor();
        await page.getByRole("button", { name: "Pause" }).click();
        await page.locator("button.plain").first().click();
        await page.locator("pre.dump").waitFor();
      } finally {
        await master.stop();
      }
    },
  },
  {
    name: "colours are chosen and kept",
    test: async (page) => {
      await page.emulateMedia({ colorScheme: "light" });
      const ground = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
      const light = await ground();
      await page.getByLabel("Colours").selectOption("dark");
      const dark = await ground();
      assert.notEqual(light, dark);
      await page.reload();
      await heading("Rack")(page);
      assert.equal(await ground(), dark);
      await page.getByLabel("Colours").selectOption("system");
    },
  },
  ...scope.behaviours,
  {
    name: "a snapshot brings the rack back, and the page stays",
    path: "/recording",
    allowed: kRackGone,
    test: async (page, { origin }) => {
      await page.getByLabel("Name").fill("before");
      await page.getByRole("button", { name: "Keep the present state" }).click();
      const row = page.getByRole("row", { name: "before" });
      await row.waitFor();
      const time = async () => (await (await fetch(`${origin}/api/v1/rack`)).json()).time_ns;
      await page.waitForTimeout(2000);
      const late = await time();
      await page.getByLabel("Name").fill("of-the-run-before");
      await row.getByRole("button", { name: "Go back to it" }).click();
      await page.getByText("run-2.stator").waitFor();
      assert.ok((await time()) < late, "simulated time has gone back");
      // The page begins anew as soon as it notices that this is another run. It may also have
      // noticed that the rack was away for a moment; nothing else is wrong.
      const deadline = performance.now() + 30000;
      while ((await page.getByLabel("Name").inputValue()) !== "") {
        assert.ok(performance.now() < deadline, "the page does not notice that this is another run");
        await page.waitForTimeout(50);
      }
      await page.getByText("The rack cannot be reached").waitFor({ state: "detached" });
      assert.deepEqual(await page.locator(".notice.bad").allInnerTexts(), []);
      // The page's token still is the rack's.
      await page.getByLabel("Name").fill("after");
      await page.getByRole("button", { name: "Keep the present state" }).click();
      await page.getByRole("row", { name: "after" }).waitFor();
    },
  },
  // The last, since the rack that comes back has another token.
  {
    name: "the page comes back when the rack does",
    allowed: kRackGone,
    test: async (page, { rack }) => {
      await heading("Rack")(page);
      await rack.stop();
      await page.getByText("The rack cannot be reached").waitFor();
      await rack.start();
      await page.getByText("The rack cannot be reached").waitFor({ state: "detached" });
      await page.getByText("running", { exact: true }).waitFor();
      await page.locator("a.card", { hasText: "feeder" }).waitFor();
    },
  },
];
