// Ten things that a person comes to do, by the names that the page shows alone.
import { execFile } from "node:child_process";
import { promisify } from "node:util";
import { join } from "node:path";

import { expect } from "@playwright/test";

import { heading, test } from "./fixtures.mjs";
import { kRackGone } from "./rack.mjs";

const run = promisify(execFile);
const slow = { timeout: 60_000 };
/// What a browser says when a view is left before its stream has begun.
const kLeft = "closed before the connection is established";

// A run that is not recorded, for one of the tasks is to record it.
test.beforeAll(async ({ rack }) => {
  await rack.stop();
  await rack.start({ recorded: false });
});
test.afterAll(async ({ rack }) => {
  await rack.stop();
  await rack.start();
});

/// From the first page, by the list of what people come to do.
async function howDoI(open, task, ...allowed) {
  const page = await open("/rack", kLeft, ...allowed);
  await page.getByRole("link", { name: "How do I …" }).click();
  await page.getByRole("link", { name: task, exact: true }).click();
  return page;
}

/// From the first page to that of a device.
async function toDevice(open, name, ...allowed) {
  const page = await open("/rack", kLeft, ...allowed);
  await page.getByRole("navigation", { name: "Views", exact: true }).getByRole("link", { name, exact: true }).click();
  await heading(page, name);
  return page;
}

/// Takes control of the device, enables one of its axes and does `act` with it. On a busy machine the watchdog of process data may
/// expire meanwhile; then it is to be done again.
async function withEnabled(page, axis, act) {
  await page.getByRole("button", { name: /^Take control/ }).click();
  const panel = page.getByRole("region", { name: `Move ${axis} by hand` });
  await panel.waitFor(slow);
  await expect(async () => {
    const enable = panel.getByRole("button", { name: "Enable" });
    if (await enable.isVisible()) {
      await enable.click({ timeout: 5_000 });
      await panel.getByText("Operation enabled").waitFor({ timeout: 10_000 });
    }
    await act(panel);
  }).toPass({ timeout: 120_000 });
}

/// What the page gives to be kept as a file.
async function saved(page, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name }).click()]);
  return download;
}

async function runThis(page) {
  await page.getByText("no problem").waitFor();
  await page.getByRole("button", { name: "Run this" }).click();
  await page.getByText("as it runs").waitFor(slow);
}

test("tasks: find why the drive refused", async ({ open }) => {
  const page = await toDevice(open, "gantry");
  await page.getByRole("button", { name: /^Take control/ }).click();
  const axis = page.getByRole("region", { name: "Move axis 0 by hand" });
  await axis.getByText("Controlword").click();
  for (const bit of ["switch on", "enable voltage", "quick stop not", "enable operation"]) {
    await axis.getByRole("button", { name: new RegExp(`\\d ${bit}$`) }).click();
  }
  await axis.getByRole("button", { name: /^Write/ }).click();
  // The person has seen that nothing moves, and asks.
  await page.getByRole("link", { name: "How do I …" }).click();
  await page.getByRole("searchbox", { name: "What do you want to do?" }).fill("refused");
  await page.getByRole("link", { name: "Find why a drive refused" }).click();
  const row = page.getByRole("row", { name: /gantry.*controlword 000Fh/ }).first();
  await row.getByRole("button", { name: /^Explain/ }).click();
  await page.getByText(/Go step by step/).waitFor();
  await page.getByRole("link", { name: "gantry", exact: true }).first().click();
  await page.getByRole("button", { name: "Give back" }).click();
});

test("tasks: home axis 2", async ({ open }) => {
  const page = await toDevice(open, "gantry");
  await withEnabled(page, "axis 2", async (axis) => {
    await axis.getByLabel("Where home is").selectOption({ label: "35 here, as it stands" });
    await axis.getByRole("button", { name: "Home axis 2" }).click({ timeout: 5_000 });
    await axis.getByText("homed", { exact: true }).waitFor({ timeout: 10_000 });
  });
  await page.getByRole("button", { name: "Give back" }).click();
});

test("tasks: see the following error while the load steps", async ({ open }) => {
  const page = await howDoI(open, "See the following error while the load steps");
  const channel = (name) => page.getByRole("row").filter({ has: page.getByRole("rowheader", { name: new RegExp(name) }) });
  await channel("servo.axis0.following_error").waitFor();
  await page.getByLabel("Step to").fill("0.04");
  await page.getByRole("button", { name: "Step", exact: true }).click();
  await channel("servo.axis0.load_torque").getByRole("cell", { name: "0.04", exact: true }).first().waitFor();
  await page.getByRole("button", { name: "Step back to 0 N m" }).click();
  await page.getByRole("button", { name: "Step", exact: true }).waitFor();
});

test("tasks: let the encoder slip", async ({ open }) => {
  const page = await howDoI(open, "Let an encoder slip");
  await page.getByRole("button", { name: "Put it there" }).click();
  const row = page.getByRole("row", { name: /encoder-slip.*servo/ });
  await row.getByText("active").waitFor();
  await row.getByRole("link", { name: "Watch it in the oscilloscope" }).click();
  await page.getByRole("combobox", { name: "Preset" }).waitFor();
  await page.goBack();
  await page.getByRole("button", { name: "Clear all" }).click();
  await page.getByText(/No fault is armed or active/).waitFor();
});

test("tasks: record and replay", async ({ open, rack }) => {
  const page = await howDoI(open, "Record a run and replay it", ...kRackGone);
  await page.getByRole("button", { name: "Restart the rack and record" }).click();
  await page.getByRole("button", { name: "Stop recording" }).click(slow);
  const command = await page.getByText(/^stator replay \S+\.stator$/).innerText();
  await page.getByRole("button", { name: "Download", exact: true }).waitFor();
  const [, ...parameters] = command.split(" ");
  const { stdout } = await run(rack.stator, parameters, { cwd: rack.folder });
  expect(stdout).toMatch(/the same/);
});

test("tasks: change a motor", async ({ open }) => {
  const page = await toDevice(open, "gantry", ...kRackGone);
  await page.getByRole("link", { name: "Motor and load" }).click();
  await page.getByLabel("motor", { exact: true }).selectOption("QSH5718-55-30-098");
  await runThis(page);
  await expect(page.getByLabel("motor", { exact: true })).toHaveValue("QSH5718-55-30-098");
});

test("tasks: save a setup", async ({ open }) => {
  const page = await howDoI(open, "Save a setup of the oscilloscope");
  const runs = page.getByText(/^[1-9]\d* rows/);
  await runs.waitFor();
  const setup = await saved(page, "Save setup");
  await page.getByLabel("Setup file").setInputFiles(await setup.path());
  await page.getByRole("combobox", { name: "Preset" }).getByText("own setup").waitFor({ state: "attached" });
  await runs.waitFor();
});

test("tasks: export a picture", async ({ open }) => {
  const page = await howDoI(open, "Export a picture");
  await page.getByText(/^[1-9]\d* rows/).waitFor();
  expect((await saved(page, "Save picture")).suggestedFilename()).toBe("scope.png");
  expect((await saved(page, "Save values")).suggestedFilename()).toBe("scope.csv");
});

test("tasks: wire a switch", async ({ open }) => {
  const page = await toDevice(open, "gantry", ...kRackGone);
  await page.getByRole("searchbox", { name: "Search the inputs of gantry" }).fill("home switch");
  await page.getByRole("link", { name: "Wire axis0 home switch" }).click();
  await expect(page.getByLabel("to", { exact: true })).toHaveValue("gantry.axis0.home_switch");
  await page.getByLabel("from", { exact: true }).fill("feeder.output0");
  await runThis(page);
  await expect(page.getByRole("textbox", { name: "Rack file in TOML" })).toHaveValue(
    /from = "feeder.output0"\nto = "gantry.axis0.home_switch"/,
  );
});

test("tasks: write a test", async ({ open, rack }) => {
  const page = await toDevice(open, "gantry");
  await withEnabled(page, "axis 1", async (axis) => {
    await axis.getByLabel(/^Target or distance/).fill("0.5");
    await axis.getByRole("button", { name: "Move to" }).click({ timeout: 5_000 });
    await axis.getByText("target reached").waitFor({ timeout: 10_000 });
  });
  await page.getByRole("link", { name: "Write a test" }).click();
  await page.getByRole("region", { name: "Scenario" }).getByText('do = "move"').waitFor();
  await page.getByLabel("Signal", { exact: true }).fill("gantry.axis1.shaft_position");
  await page.getByLabel(/^Value/).fill("0.5");
  await page.getByRole("button", { name: "Add to the test" }).click();
  const file = join(rack.folder, "my-test.toml");
  await (await saved(page, "Download my-test.toml")).saveAs(file);
  const { stdout } = await run(rack.stator, ["test", file]);
  expect(stdout).toContain("1 of 1 scenarios passed");
  await page.getByRole("link", { name: "gantry", exact: true }).click();
  await page.getByRole("button", { name: "Give back" }).click();
});
