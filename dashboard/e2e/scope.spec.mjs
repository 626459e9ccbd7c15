// The oscilloscope, as a person uses it.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";

import { expect } from "@playwright/test";

import { out, test } from "./fixtures.mjs";
import { channel, kAxis, load, row, rowsAtLeast, setupOf, statistics } from "./scope.mjs";

const state = (page, text) => page.locator(".scope-state", { hasText: text }).waitFor();

/// What the table says of a channel, by the titles of its columns. One channel is measured after the
/// other, so what it says counts once it says it twice.
async function measured(page, name) {
  const kPause = 800;
  const titles = await page.locator(".scope-channels thead th").allTextContents();
  let before;
  for (let i = 0; i < 20; ++i) {
    await page.waitForTimeout(kPause);
    const cells = await row(page, name).locator("th, td").allTextContents();
    const now = cells.join();
    if (now === before) {
      return Object.fromEntries(titles.map((title, i) => [title, Number(cells[i])]));
    }
    before = now;
  }
  throw new Error(`what is measured of ${name} does not settle: ${before}`);
}

/// The channels with which losing steps is seen; 51200 microsteps and 200 full steps are one turn.
const kStallChannels = [
  channel(`${kAxis}.load_torque`, "Nm"),
  channel(`${kAxis}.load_angle`, "deg"),
  channel(`${kAxis}.position_demand`, "microstep", null, { visible: false }),
  channel(`${kAxis}.shaft_position`, "rev", null, { visible: false }),
  channel("demand", "full step", `${kAxis}.position_demand / 256`),
  channel("shaft", "full step", `${kAxis}.shaft_position * 200`),
  channel("lost", "steps", "demand - shaft"),
  channel("fours", "steps", "4 * round(lost / 4)"),
];
const stallSetup = setupOf({
  span: 5e9,
  channels: kStallChannels,
  trigger: { mode: "auto", source: { kind: "state", channel: "fours", mask: null, value: null }, before: 0.3, holdOff: 0 },
});

async function saved(page, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name, exact: true }).click()]);
  return readFile(await download.path());
}

/// How often an angle in degrees went from one end of its range to the other, forward less backward.
function turns(angles) {
  const kJump = 240;
  return angles.slice(1).reduce((sum, angle, i) => sum + (angles[i] - angle > kJump ? 1 : angle - angles[i] > kJump ? -1 : 0), 0);
}

/// A test while the first axis turns, one revolution per second, moved by the master inside the rack: drives give it two seconds
/// for its next frame, which a master beside it would not be given by a machine with other things to do.
async function whileTurning(rack, test) {
  const ask = async (method, path, body) => {
    const answer = await fetch(`${rack.origin}/api/v1/devices/gantry/manual${path}`, {
      method,
      headers: { "Content-Type": "application/json", Authorization: `Bearer ${new URL(rack.link).hash.slice(7)}` },
      ...(body ? { body: JSON.stringify(body) } : {}),
    });
    assert.ok(answer.ok, await answer.clone().text());
    return answer.json();
  };
  await ask("PUT", "");
  try {
    await expect.poll(async () => (await ask("GET", "")).phase).toBe("active");
    await ask("POST", "/0", { command: "enable" });
    await expect.poll(async () => (await ask("GET", "")).axes[0].enabled).toBe(true);
    await ask("POST", "/0", { command: "move", relative: true, value: 6_000_000, velocity: 51_200 });
    await test();
  } finally {
    await ask("DELETE", "");
  }
}

test("scope: opens with a first picture that runs, and has it in its address", async ({ open }) => {
  const page = await open("/scope");
  await row(page, `${kAxis}.position_demand`).waitFor();
  await row(page, `${kAxis}.following_error`).waitFor();
  await state(page, "running");
  await rowsAtLeast(page, 500);
  assert.equal(new URL(page.url()).hash, "#/scope?preset=position&device=gantry&axis=axis0");
  // Each preset that is offered samples; what an event of the rack may disturb is no business of this.
  const presets = page.getByRole("combobox", { name: "Preset" });
  const devices = page.getByRole("combobox", { name: "Device", exact: true }).first();
  const names = [];
  for (const device of await devices.locator("option").allTextContents()) {
    await devices.selectOption({ label: device });
    for (const preset of await presets.locator("option:not([value=own])").allTextContents()) {
      await presets.selectOption({ label: preset });
      const before = (await statistics(page)).received;
      await rowsAtLeast(page, before + 20, `${preset} of ${device} samples`);
      assert.equal(await page.locator(".notice.bad").count(), 0, `${preset} of ${device}`);
      names.push(`${device}: ${preset}`);
    }
  }
  console.log(`        ${names.join(", ")}`);
  for (const expected of [
    "gantry axis2: Stall",
    "servo axis0: Currents",
    "spindle axis0: Bus load",
    "feeder axis0: Homing",
    "io axis: Stall",
  ]) {
    assert.ok(names.includes(expected), expected);
  }
  assert.ok(!names.includes("servo axis0: Stall"));
});

test("scope: an address shows what it says, own setups included", async ({ open }) => {
  const page = await open("/scope?preset=currents&device=servo");
  await row(page, "servo.axis0.quadrature_current").waitFor();
  assert.match(page.url(), /preset=currents&device=servo/);
  // What is changed is one's own from then on: in the address, and at the next visit.
  await page.getByLabel("Shown", { exact: true }).selectOption(String(2e9));
  await page.waitForURL(/#\/scope\?setup=/);
  const passedOn = new URL(page.url()).hash.slice(1);
  const own = page.getByRole("combobox", { name: "Preset" });
  assert.equal(await own.inputValue(), "own");
  const other = await open(passedOn);
  await row(other, "servo.axis0.quadrature_current").waitFor();
  assert.equal(await other.getByLabel("Shown", { exact: true }).inputValue(), String(2e9));
  const next = await open("/scope");
  await row(next, "servo.axis0.quadrature_current").waitFor();
  // A preset and back.
  const menu = next.getByRole("combobox", { name: "Preset" });
  await menu.selectOption("velocity");
  await row(next, "gantry.axis0.velocity_demand").waitFor();
  await menu.selectOption("own");
  await row(next, "servo.axis0.quadrature_current").waitFor();
  const device = await open("/device/spindle");
  await device.getByRole("navigation", { name: "Views of spindle" }).getByRole("link", { name: "Oscilloscope" }).click();
  await row(device, "spindle.axis0.behind").waitFor();
  const wrong = await open("/scope?preset=stall&device=servo");
  await wrong.getByText("There is nothing to show for").waitFor();
});

test("scope: ten signals at 20 kHz come complete, or what is lost is counted", async ({ open, origin }) => {
  const page = await open("/scope");
  const { signals } = await (await fetch(`${origin}/api/v1/signals?names=${kAxis}.*`)).json();
  await load(page, setupOf({ channels: signals.slice(0, 10).map(({ name, unit }) => channel(name, unit)) }));
  const found = await rowsAtLeast(page, 40_000);
  console.log(`        ${found.received} rows of ${found.expected}, ${found.dropped} dropped, ${found.fps} frames/s`);
  assert.equal(found.expected - found.received, found.dropped);
});

test("scope: an event triggers at its exact time", async ({ open, origin, link }) => {
  const page = await open("/events");
  const token = /token=(\w+)/.exec(link)[1];
  const put = (value) =>
    fetch(`${origin}/api/v1/inputs/${kAxis}.load_torque`, {
      method: "PUT",
      headers: { "Content-Type": "application/json", Authorization: `Bearer ${token}` },
      body: JSON.stringify({ value }),
    });
  // Of this event the page has heard before it waits for one.
  await put(0.012);
  await page
    .getByText(/0\.012/)
    .first()
    .waitFor();
  await page.getByRole("link", { name: "Oscilloscope" }).first().click();
  await load(
    page,
    setupOf({
      span: 20e6,
      channels: [channel(`${kAxis}.load_torque`, "Nm")],
      trigger: {
        mode: "single",
        source: { kind: "event", severity: "information", device: "", rule: "input-set" },
        before: 0.5,
        holdOff: 0,
      },
    }),
  );
  await rowsAtLeast(page, 2000);
  await state(page, "waiting for trigger");
  assert.equal((await put(0.05)).status, 200);
  await state(page, "stopped");
  const { events } = await (await fetch(`${origin}/api/v1/events`)).json();
  const event = events.findLast(({ rule }) => rule === "input-set");
  await page.getByText(`at ${(event.time_ns / 1e9).toFixed(9)} s`).waitFor();
  const torque = await measured(page, `${kAxis}.load_torque`);
  assert.deepEqual([torque.Minimum, torque.Maximum], [0.012, 0.05]);
  await put(0);
});

test("scope: a load that is too heavy costs steps in fours", async ({ open, rack }) => {
  const page = await open("/scope");
  await whileTurning(rack, async () => {
    await page.setViewportSize({ width: 1600, height: 1000 });
    await load(page, stallSetup);
    await rowsAtLeast(page, 40_000);
    await page.getByRole("combobox", { name: "Input", exact: true }).selectOption(`${kAxis}.load_torque`);
    await page.getByLabel("Shown", { exact: true }).selectOption(String(20e6));
    await page.getByLabel("Trigger mode").selectOption("single");
    await state(page, "waiting for trigger");
    const slider = page.locator(".scope-inputs input[type=range]");
    await slider.focus();
    // The arrow keys move it; each lets a few periods of the rotor's swinging pass.
    for (let load = 0; load > -0.9 && (await page.locator(".scope-state").textContent()) !== "stopped"; load -= 0.02) {
      await slider.fill(String(Number(load.toFixed(2))));
      await page.waitForTimeout(120);
    }
    await state(page, "stopped");
    await slider.fill("0");
    await page.waitForTimeout(400);
    await page.screenshot({ path: join(out, "stall.png") });
    const angle = await measured(page, `${kAxis}.load_angle`);
    assert.ok(angle.Minimum < -150 && angle.Maximum > 150, `the load angle goes round, not from ${angle.Minimum} to ${angle.Maximum}`);
    // Each time it goes round, four full steps are lost: exactly one electrical period.
    await page.getByLabel("SI units").uncheck();
    const lines = (await saved(page, "Save values"))
      .toString()
      .trimEnd()
      .split("\r\n")
      .map((line) => line.split(","));
    const column = (name) => lines.slice(1).map((line) => Number(line[lines[0].findIndex((title) => title.startsWith(name))]));
    const fours = column("fours");
    const rounds = turns(column(`${kAxis}.load_angle`));
    console.log(`        ${fours.at(-1) - fours[0]} full steps in ${rounds} rounds of the load angle, in ${lines.length - 1} samples`);
    assert.ok(rounds >= 3);
    assert.equal(fours.at(-1) - fours[0], 4 * rounds);
    const jumps = new Set(fours.slice(1).map((value, i) => value - fours[i]));
    assert.deepEqual([...jumps].sort(), [0, 4]);
    // Without the load the rotor is caught again, some electrical periods behind.
    await page.getByLabel("Shown", { exact: true }).selectOption(String(1e9));
    await page.getByLabel("Trigger on").selectOption("none");
    await page.getByRole("button", { name: "Run", exact: true }).click();
    await rowsAtLeast(page, (await statistics(page)).received + 40_000);
    await page.getByRole("button", { name: "Stop", exact: true }).click();
    await page.waitForTimeout(600);
    const after = await measured(page, "lost");
    const periods = after.Mean / 4;
    console.log(`        ${after.Mean} full steps lost: ${periods} electrical periods`);
    assert.ok(periods > 0.9 && Math.abs(periods - Math.round(periods)) < 0.1, `${after.Mean} steps are no multiple of four`);
    await page.screenshot({ path: join(out, "stall-caught.png") });
  });
});

test("scope: keys alone run, stop, zoom and move cursors", async ({ open }) => {
  const page = await open("/scope");
  await load(page, setupOf({ channels: [channel(`${kAxis}.position_demand`, "microstep")] }));
  await rowsAtLeast(page, 40_000);
  const picture = page.getByRole("application", { name: "Signals over time" });
  await picture.focus();
  await page.keyboard.press("Space");
  await state(page, "stopped");
  // Not before, since a picture that goes on leaves them behind on a busy machine.
  await page.getByLabel("Time cursors A and B").check();
  await picture.focus();
  const a = page.getByLabel("A", { exact: true });
  const before = Number(await a.inputValue());
  await page.keyboard.press("a");
  await page.keyboard.press("ArrowRight");
  await expect.poll(async () => Number(await a.inputValue())).toBeGreaterThan(before);
  const rows = async () => (await page.getByText(/B − A =/).textContent()) ?? "";
  assert.match(await rows(), /B − A = \d+(\.\d+)? ms, 1\/\|B − A\| = \d/);
  await page.keyboard.press("Escape");
  await page.keyboard.press("+");
  await page.keyboard.press("ArrowLeft");
  await expect(page.getByRole("button", { name: "Follow" })).toHaveAttribute("aria-pressed", "false");
  await page.keyboard.press("Space");
  await page.keyboard.press("Home");
  await state(page, "running");
});

test("scope: what is recorded is written as CSV, PNG and setup", async ({ open }) => {
  const page = await open("/scope");
  const channels = [channel(`${kAxis}.load_angle`, "deg"), channel("twice", "deg", `2 * ${kAxis}.load_angle`)];
  await load(page, setupOf({ channels }));
  await rowsAtLeast(page, 4000);
  await page.getByRole("button", { name: "Stop", exact: true }).click();
  await page.getByLabel("Rows to export").selectOption("all");
  const lines = (await saved(page, "Save values")).toString().trimEnd().split("\r\n");
  assert.equal(lines[0], `time [s],${kAxis}.load_angle [rad],twice [rad]`);
  assert.ok(lines.length > 4000);
  const times = lines.slice(1).map((line) => BigInt(line.split(",")[0].replace(".", "")));
  times.slice(1).forEach((time, i) => assert.equal(time - times[i], 50_000n));
  assert.equal((await saved(page, "Save picture")).subarray(1, 4).toString(), "PNG");
  assert.deepEqual(JSON.parse((await saved(page, "Save setup")).toString()).channels, channels);
  await page
    .getByLabel("Setup file")
    .setInputFiles({ name: "x.json", mimeType: "application/json", buffer: Buffer.from('{"form":"other"}') });
  await page.getByText('form must be one of stator-scope, not "other"').waitFor();
});
