// A rack that is away for a moment, and is another run or another rack when it comes back.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { promisify } from "node:util";

import { expect } from "@playwright/test";

import { heading, test } from "./fixtures.mjs";
import { kRackGone } from "./rack.mjs";

test("a snapshot brings the rack back, and the page stays", async ({ open, origin, rack }) => {
  // To go back is to do all again up to there, of which there is little in a young run.
  await rack.stop();
  await rack.start();
  const page = await open("/recording", ...kRackGone);
  await page.getByLabel("Name").fill("before");
  await page.getByRole("button", { name: "Keep the present state" }).click();
  const row = page.getByRole("row", { name: "before" });
  await row.waitFor();
  const time = () =>
    fetch(`${origin}/api/v1/rack`)
      .then((answer) => answer.json())
      .then(({ time_ns }) => time_ns)
      .catch(() => Infinity); // while the rack is away
  await page.waitForTimeout(5000); // by so much simulated time goes back
  const late = await time();
  await page.getByLabel("Name").fill("of-the-run-before");
  await row.getByRole("button", { name: "Go back to it" }).click();
  await expect.poll(time, { message: "simulated time has gone back", intervals: [20] }).toBeLessThan(late);
  await page.getByRole("cell", { name: /run.*-2\.stator$/ }).waitFor();
  // The page begins anew as soon as it notices that this is another run. It may also have
  // noticed that the rack was away for a moment; nothing else is wrong.
  await expect(page.getByLabel("Name")).toHaveValue("");
  await page.getByText("The rack cannot be reached").waitFor({ state: "detached" });
  assert.deepEqual(await page.locator(".notice.bad").allInnerTexts(), []);
  // The page's token still is the rack's.
  await page.getByLabel("Name").fill("after");
  await page.getByRole("button", { name: "Keep the present state" }).click();
  await page.getByRole("row", { name: "after" }).waitFor();
});

test("the page comes back when the rack does", async ({ open, rack }) => {
  const page = await open("/rack", ...kRackGone);
  await heading(page, "Rack");
  await rack.stop();
  await page.getByText("The rack cannot be reached").waitFor();
  await rack.start();
  await page.getByText("The rack cannot be reached").waitFor({ state: "detached" });
  await page.getByText("running", { exact: true }).waitFor();
  await page.locator("a.card", { hasText: "feeder" }).waitFor();
});

test("a recording is begun and ended on the page, and replays to the bit", async ({ open, rack }) => {
  await rack.stop();
  await rack.start({ recorded: false });
  try {
    const page = await open("/recording", ...kRackGone);
    await page.getByLabel("Name of the file").fill("from-the-page");
    await page.getByRole("button", { name: "Restart the rack and record" }).click();
    const stop = page.getByRole("button", { name: "Stop recording" });
    await stop.waitFor();
    const master = rack.move(2);
    await page.waitForTimeout(3000);
    await master.stop();
    await stop.click();
    await page.getByText("stator replay from-the-page.stator").waitFor();
    const button = page.getByRole("button", { name: "Download", exact: true });
    await button.waitFor();
    const told = async () => (await (await fetch(`${rack.origin}/api/v1/recording`)).json()).bytes;
    const file = join(rack.folder, "from-the-page.stator");
    while ((await readFile(file)).length < (await told())) {
      await page.waitForTimeout(50); // the last of it is on its way to the disk
    }
    const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
    assert.equal(download.suggestedFilename(), "from-the-page.stator");
    const copy = join(rack.folder, "copy.stator");
    await download.saveAs(copy);
    assert.ok((await readFile(copy)).equals(await readFile(file)));
    const { stdout } = await promisify(execFile)(rack.stator, ["replay", copy]);
    console.log(`        ${stdout.trim().split("\n").at(-1)}`);
  } finally {
    await rack.stop();
    await rack.start();
  }
});
