// Where views lead on: to masters, to what an event means, to faults, and how old what they show is.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";

import { expect } from "@playwright/test";

import { explainRule, guides } from "../src/event_help.ts";
import { heading, lookAt, test } from "./fixtures.mjs";
import { repository } from "./rack.mjs";

/// Writes an entry with the token, as a page does; gives the status of the answer.
async function write(origin, link, path, value) {
  const answer = await fetch(`${origin}/api/v1/devices/${path}`, {
    method: "PUT",
    headers: { Authorization: `Bearer ${new URL(link).hash.slice(7)}`, "Content-Type": "application/json" },
    body: JSON.stringify({ value }),
  });
  return answer.status;
}

test("the rack page has the lines for masters of its links", async ({ open, rack, context }) => {
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  const page = await open("/rack");
  await heading(page, "Rack");
  await page.getByText("Connect a master", { exact: true }).click();
  const scan = page.getByText(`stator scan --link udp:127.0.0.1:${rack.udp}`);
  await scan.waitFor();
  await page.getByRole("button", { name: "Copy the lines for stator" }).click();
  await page.getByText("Copied").waitFor();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.ok(copied.startsWith(`stator scan --link udp:127.0.0.1:${rack.udp}\n`), copied);
  await page.getByRole("button", { name: /SOEM/ }).click();
  await page.getByText(/open a network interface and cannot speak over UDP/).waitFor();
  await page.getByText("Connect a master or another program").click();
  await page
    .getByRole("region", { name: /Lines for python-canopen/ })
    .first()
    .waitFor();
  await page.getByText("Connect a host").click();
  await page
    .getByText(/ConnectionManager\(/)
    .first()
    .waitFor();
  await lookAt(page, "connect");
});

test("every kind of event is explained, by documents that there are", ({ rack }) => {
  const rules = execFileSync(rack.stator, ["test", "--events"], { encoding: "utf8" }).trim().split("\n");
  assert.ok(rules.length > 100, String(rules.length));
  assert.deepEqual(
    rules.filter((rule) => explainRule(rule) === null),
    [],
  );
  assert.deepEqual(
    guides().filter((guide) => !existsSync(join(repository, "docs", guide))),
    [],
  );
});

test("an event says what it means and leads to its object", async ({ open, origin, link }) => {
  assert.equal(await write(origin, link, "gantry/objects/6083/00", 500_000), 200);
  const page = await open("/events");
  await page.getByRole("searchbox").fill("6083h gantry");
  await page
    .getByRole("button", { name: /Explain event/ })
    .first()
    .click();
  await page.getByText(/changed from outside, not by the master/).waitFor();
  await page.getByText("docs/how-to/dashboard.md").waitFor();
  await lookAt(page, "explanation");
  await page.getByRole("link", { name: /Object 6083h/ }).click();
  await heading(page, "gantry");
  await page.locator("tr", { hasText: "6083h:00" }).waitFor();
});

test("a fault is tried from where it would happen", async ({ open, origin }) => {
  const page = await open("/device/gantry");
  await page.getByRole("button", { name: "axis1", exact: true }).click();
  await page.getByRole("button", { name: "Try a fault at gantry, axis1" }).click();
  const dialog = page.getByRole("dialog");
  await dialog.getByLabel("What goes wrong").selectOption("motor-stall");
  await dialog.getByRole("combobox", { name: "where" }).getByText("gantry, axis1").waitFor({ state: "attached" });
  await lookAt(page, "try-fault");
  await dialog.getByRole("button", { name: "Put it there" }).click();
  await dialog.waitFor({ state: "hidden" });
  const { faults } = await (await fetch(`${origin}/api/v1/faults`)).json();
  const put = faults.find((fault) => fault.kind === "motor-stall" && fault.state !== "done");
  assert.match(put.target, /gantry.*1/);
  await page.getByRole("link", { name: "Write a test" }).click();
  const lines = page.getByRole("region", { name: "Scenario" });
  await lines.getByText('fault = { kind = "motor-stall", device = "gantry", axis = 1').waitFor();
  await page.getByLabel("Signal", { exact: true }).fill("gantry.axis1.shaft_speed");
  await page.getByRole("button", { name: "Add to the test" }).waitFor();
  await lookAt(page, "write-test");
  await page.goBack();
  await page.getByRole("link", { name: "Faults", exact: true }).click();
  await page.getByRole("link", { name: "Watch it in the oscilloscope" }).waitFor();
  await lookAt(page, "active-fault");
  await page.getByRole("button", { name: "Clear all" }).click();
  await page.getByText(/No fault is armed or active/).waitFor();
});

test("a fault is tried at the input that it is about", async ({ open }) => {
  const page = await open("/device/gantry?inputs=axis0+switch");
  await page.getByRole("button", { name: "Try a fault at right switch of gantry, axis0" }).click();
  const dialog = page.getByRole("dialog");
  await dialog.getByRole("heading", { name: "switch-stuck" }).waitFor();
  await expect(dialog.getByRole("combobox", { name: "switch", exact: true })).toHaveValue("right");
  await dialog.getByRole("combobox", { name: "where" }).getByText("gantry, axis0").waitFor({ state: "attached" });
  await dialog.getByRole("button", { name: "Close" }).click();
  await page.getByRole("searchbox", { name: "Search the inputs of gantry" }).fill("axis0 supply voltage");
  await lookAt(page, "fault-of-input");
  await page.getByRole("button", { name: "Try a fault at supply voltage of gantry, axis0" }).click();
  const kinds = dialog.getByLabel("What goes wrong").getByRole("option");
  await expect(kinds).toHaveText([/^supply-sag:/, /^supply-overvoltage:/, /^supply-resistance:/]);
});

test("a fault is tried at a part of a board", async ({ open, origin }) => {
  const page = await open("/device/io?inputs=door+stuck");
  await page.getByRole("button", { name: "Try a fault at stuck of io, door" }).click();
  const dialog = page.getByRole("dialog");
  await dialog.getByRole("heading", { name: "switch-stuck" }).waitFor();
  await expect(dialog.getByRole("combobox", { name: "where" })).toContainText("io, a part on its board");
  await dialog.getByRole("button", { name: "Put it there" }).click();
  await dialog.waitFor({ state: "hidden" });
  const stuck = async () => (await (await fetch(`${origin}/api/v1/inputs/io.door.stuck`)).json()).value;
  await expect.poll(stuck).toBe(2);
  await page
    .getByRole("link", { name: "Fault is put" })
    .or(page.getByRole("link", { name: "Faults", exact: true }))
    .first()
    .click();
  await page.getByRole("button", { name: "Clear all" }).click();
  await expect.poll(stuck).toBe(0);
});

test("bars show the limits of the drive", async ({ open, origin, link }) => {
  const page = await open("/device/gantry?units=device");
  const before = (await (await fetch(`${origin}/api/v1/devices/gantry/objects/6065/00`)).json()).value;
  assert.equal(await write(origin, link, "gantry/objects/6065/00", 1234), 200);
  await page.getByText(/Limits: window \(6065h\), negative −1\u202f234.µstep, window \(6065h\), positive 1\u202f234.µstep/).waitFor();
  assert.equal(await write(origin, link, "gantry/objects/6065/00", before), 200);
});

test("what a master sees tells when no master looks", async ({ open, rack }) => {
  const page = await open("/device/gantry");
  const silent = page.getByText(/No master has spoken on segment 0|The master of segment 0 has been silent/);
  await silent.waitFor();
  await lookAt(page, "silent-master");
  const master = rack.move(100);
  try {
    await silent.waitFor({ state: "detached" });
  } finally {
    await master.stop();
  }
  await silent.waitFor();
});
