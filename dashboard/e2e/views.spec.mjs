// Every view, from a phone to a wide screen and in both themes: nothing too wide, nothing that axe finds, a silent console.
import { heading, lookAt, test } from "./fixtures.mjs";
import * as scope from "./scope.mjs";

const text = (name, found) => async (page) => {
  await heading(page, name);
  await page.getByText(found).first().waitFor();
  await page.waitForTimeout(600);
};

const views = [
  { name: "rack", path: "/rack", ready: text("Rack", "Networks") },
  { name: "how-do-i", path: "/how", ready: text("How do I …", "Home an axis") },
  { name: "test-empty", path: "/test", ready: text("Write a test", "Nothing has been done") },
  { name: "gantry", path: "/device/gantry", ready: text("gantry", "6041h") },
  { name: "servo", path: "/device/servo", ready: text("servo", "6041h") },
  { name: "spindle", path: "/device/spindle", ready: text("spindle", "6041h") },
  { name: "io", path: "/device/io", ready: text("io", "Inputs") },
  { name: "feeder", path: "/device/feeder", ready: text("feeder", "Shaft speed") },
  { name: "objects", path: "/device/gantry/objects", ready: text("gantry", "Device type") },
  { name: "signals", path: "/device/gantry/signals", ready: text("gantry", "axis0.torque") },
  {
    name: "program",
    path: "/device/feeder/program",

    ready: text("feeder", "MVP ABS"),
  },
  { name: "events", path: "/events", ready: text("Events", "spindle") },
  { name: "traffic", path: "/traffic", ready: text("Traffic", /LRW|FPRD|BRD|LWR|LRD/) },
  { name: "faults", path: "/faults", ready: text("Faults", "Kinds") },
  { name: "rack-file", path: "/rack-file", ready: text("Rack file", "no problem") },
  { name: "recording", path: "/recording", ready: (page) => heading(page, "Recording") },
  { name: "scope", path: "/scope", ready: scope.ready },
];

let master;
test.beforeAll(async ({ rack }) => {
  master = rack.move(60);
  await new Promise((done) => setTimeout(done, 1500));
});
test.afterAll(() => master?.stop());

for (const view of views) {
  test(`view ${view.name}`, async ({ open }) => {
    const page = await open(view.path);
    await page.emulateMedia({ colorScheme: "light" });
    await view.ready(page);
    await lookAt(page, view.name);
  });
}
