// What is done in the views, as a person would.
import assert from "node:assert/strict";

import { expect } from "@playwright/test";

import { heading, test } from "./fixtures.mjs";

const put = (page, address) => page.getByRole("button", { name: `Write ${address}`, exact: true });

test("the token leaves the address bar and stays in the tab", async ({ open, link }) => {
  const page = await open("/rack");
  await heading(page, "Rack");
  assert.ok(!page.url().includes("token"), page.url());
  const kept = await page.evaluate(() => sessionStorage.getItem("stator.token"));
  assert.equal(`#token=${kept}`, new URL(link).hash);
});

test("keys alone lead from view to view", async ({ open }) => {
  const page = await open("/rack");
  await heading(page, "Rack");
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement?.textContent?.trim()), "Skip to the content");
  for (let i = 0; i < 20; ++i) {
    await page.keyboard.press("Tab");
    if ((await page.evaluate(() => document.activeElement?.textContent?.trim())) === "gantry") {
      break;
    }
  }
  const ring = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.equal(ring, "solid");
  await page.keyboard.press("Enter");
  await heading(page, "gantry");
});

test("shafts turn as the motors do", async ({ open }) => {
  const page = await open("/rack");
  const shaft = page.locator("a.card", { hasText: "feeder" }).locator(".shaft g").first();
  const seen = new Set();
  await expect.poll(async () => seen.add(await shaft.getAttribute("transform")).size, { timeout: 120_000 }).toBeGreaterThanOrEqual(3);
});

test("the load is set with a slider and comes back as a signal", async ({ open, origin }) => {
  const page = await open("/device/gantry");
  const slider = page.getByRole("slider", { name: "load torque" }).first();
  await slider.focus();
  for (let i = 0; i < 5; ++i) {
    await page.keyboard.press("ArrowRight");
  }
  // Shown and set follow the last key when the page and the rack get to it.
  const shown = async () => Number(await page.getByRole("textbox", { name: "load torque, exact" }).first().inputValue());
  await expect.poll(shown).toBeGreaterThan(0);
  const load = async () => {
    const answer = await (await fetch(`${origin}/api/v1/signals?names=gantry.axis0.load_torque`)).json();
    return answer.signals[0].value;
  };
  await expect.poll(async () => (await load()) - (await shown())).toBeCloseTo(0, 9);
  assert.ok((await load()) > 0);
});

test("inputs are found by a search, which the address keeps, and are set back where they differ", async ({ open, origin }) => {
  const page = await open("/device/servo?inputs=hall");
  const panel = page.locator("section.inputs");
  await panel.getByRole("combobox", { name: "hall fault 1" }).selectOption("2");
  assert.equal(await panel.getByRole("slider").count(), 0);
  const differing = page.getByRole("region", { name: "Differs from normal" });
  await differing.getByText("axis0 hall fault 1").waitFor();
  await panel.getByRole("searchbox").fill("nothing of this name");
  await panel.getByText(/None of the \d+ inputs/).waitFor();
  assert.match(page.url(), /inputs=nothing\+of/);
  await differing.getByRole("button", { name: "Set axis0 hall fault 1 back" }).click();
  await differing.waitFor({ state: "hidden" });
  const { value } = await (await fetch(`${origin}/api/v1/inputs/servo.axis0.hall_fault_1`)).json();
  assert.equal(value, 0);
});

test("groups of inputs stay as they were left", async ({ open }) => {
  const page = await open("/device/servo");
  const heat = page.locator("section.inputs details details").filter({ hasText: "Heat" });
  await heat.locator("summary").click();
  await heat.getByRole("slider", { name: "ambient temperature" }).waitFor();
  await page.reload();
  await heat.getByRole("slider", { name: "ambient temperature" }).waitFor();
});

test("a refused write tells why", async ({ open }) => {
  const page = await open("/device/gantry/objects?search=6060", "422");
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
});

test("values of the dictionary are refreshed while they are visible", async ({ open, origin, link }) => {
  const page = await open("/device/gantry/objects?search=607A:00");
  const row = page.locator("tr", { hasText: "607Ah:00" });
  await row.locator("td.value", { hasText: /^-?\d+$/ }).waitFor();
  const answer = await fetch(`${origin}/api/v1/devices/gantry/objects/607A/00`, {
    method: "PUT",
    headers: { Authorization: `Bearer ${new URL(link).hash.slice(7)}`, "Content-Type": "application/json" },
    body: '{"value": 4711}',
  });
  assert.equal(answer.status, 200, await answer.text());
  await row.locator("td.value", { hasText: "4711" }).waitFor();
});

test("without the right token a write asks for one", async ({ open }) => {
  const page = await open("/device/gantry?inputs=left%20switch", "401");
  await page.evaluate(() => sessionStorage.setItem("stator.token", "wrong"));
  await page.getByRole("switch", { name: "left switch" }).first().focus();
  await page.keyboard.press("Space");
  const dialog = page.getByRole("dialog");
  await dialog.waitFor();
  await page.keyboard.press("Escape");
  await dialog.waitFor({ state: "hidden" });
});

test("events are found by words and kinds", async ({ open }) => {
  const page = await open("/events");
  await page.getByRole("searchbox").fill("pre-operational spindle");
  await page
    .getByText(/NMT state of node/)
    .first()
    .waitFor();
  await page.getByRole("searchbox").fill("no such words");
  await page.getByText("No event fits the filter.").waitFor();
});

test("a fault is put and cleared", async ({ open }) => {
  const page = await open("/faults");
  await page.getByRole("region", { name: "Kinds of faults" }).getByRole("button").first().click();
  await page.getByRole("button", { name: "Put it there" }).click();
  await page
    .getByRole("button", { name: /Clear fault/ })
    .first()
    .waitFor();
  await page.getByRole("button", { name: "Clear all" }).click();
  await page.getByText("No fault is armed or active.").waitFor();
});

test("traffic can be stopped and looked into", async ({ open, rack }) => {
  const page = await open("/traffic");
  const master = rack.move(2);
  try {
    await page.locator("button.plain").first().waitFor();
    await page.getByRole("button", { name: "Pause" }).click();
    await page.locator("button.plain.mono").first().click();
    await page.locator("pre.dump").waitFor();
  } finally {
    await master.stop();
  }
});

test("traffic counts cyclic frames in one row and loses none", async ({ open, rack }) => {
  const page = await open("/traffic");
  // One move longer than the test: between two the slaves have no mapping that values could be named by.
  const master = rack.move(10_000);
  try {
    const row = page.locator(".repeating tbody tr", { hasText: "LRW" }).first();
    const count = async () => Number(await row.locator("[data-count]").getAttribute("data-count"));
    await row.waitFor();
    while ((await count()) < 500) {
      await page.waitForTimeout(100);
    }
    // The page learns the mapping once in a second.
    await expect(row.locator(".values")).toContainText("gantry 6040h");
    await page.getByRole("button", { name: "Pause" }).click();
    const uncounted = async () => {
      const told = await page.locator(".traffic-counts").evaluate((element) => ({ ...element.dataset }));
      const counts = await page.locator(".repeating [data-count]").evaluateAll((cells) => cells.map((cell) => Number(cell.dataset.count)));
      const sum = counts.reduce((all, each) => all + each, 0);
      return Number(told.received) - sum - Number(told.single);
    };
    await expect.poll(uncounted).toBe(0);
    await row.getByRole("button", { expanded: false }).click();
    await expect(page.locator(".repeating tr.recent")).toHaveCount(20);
    await row.locator("button.mono").click();
    await page.locator("pre.dump").waitFor();
    await page.getByLabel("Every frame").check();
    await expect(page.locator(".repeating")).toHaveCount(0);
    await expect.poll(() => page.getByRole("region", { name: "List of frames" }).locator("tbody tr").count()).toBeGreaterThan(100);
  } finally {
    await master.stop();
  }
});

test("colours are chosen and kept", async ({ open }) => {
  const page = await open("/rack");
  await page.emulateMedia({ colorScheme: "light" });
  const ground = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
  const light = await ground();
  await page.getByRole("button", { name: "Settings" }).click();
  await page.getByLabel("Colours").selectOption("dark");
  const dark = await ground();
  assert.notEqual(light, dark);
  await page.reload();
  await heading(page, "Rack");
  assert.equal(await ground(), dark);
  await page.getByRole("button", { name: "Settings" }).click();
  await page.getByLabel("Colours").selectOption("system");
});

test("what is chosen in a view is there again after a reload", async ({ open }) => {
  const page = await open("/rack", "closed before the connection is established"); // by the reload
  await heading(page, "Rack");
  const searches = {
    "/events": "refused words",
    "/traffic": "6041",
    "/faults": "stall",
    "/device/gantry/objects": "6060",
    "/device/gantry/signals": "torque",
    "/rack-file": "inertia",
  };
  for (const [view, words] of Object.entries(searches)) {
    await page.evaluate((hash) => (location.hash = hash), view);
    await page.getByRole("searchbox").fill(words);
    await page.reload();
    await expect(page.getByRole("searchbox")).toHaveValue(words);
  }
  await page.evaluate(() => (location.hash = "/device/gantry"));
  const axis = page.getByRole("group", { name: "Axis" }).getByRole("button", { name: "axis1" });
  await axis.click();
  await page.reload();
  await expect(axis).toHaveAttribute("aria-pressed", "true");
  await page.evaluate(() => (location.hash = "/faults"));
  await page.getByRole("button", { name: /^motor-stall/ }).click();
  await page.reload();
  await page.getByRole("heading", { level: 2, name: "motor-stall" }).waitFor();
});
