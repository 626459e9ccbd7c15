// "How do I …": what people come to do, in their words, each with the way to it.
import { useMemo } from "preact/hooks";

import type { Device, Signal, Signals } from "../api";
import { useResource, useStore } from "../hooks";
import { t } from "../language";
import { href, useChoice } from "../router";
import { type Choosing, type Place, offeredOf, placesOf } from "../scope/core/presets";
import "../styles/how_do_i.css";

interface Task {
  readonly title: string;
  /// Other words for it, to be found by.
  readonly also: string;
  /// How it is done.
  readonly steps: string;
  readonly to: string;
}

/// Where tasks lead in this rack; a task without a place is left out.
interface Places {
  readonly devices: readonly Device[];
  readonly offered: readonly Choosing[];
  readonly signals: readonly Signal[];
}

function scopeAt(found: Choosing): string {
  const { preset, place } = found;
  return href("scope", [], { preset: preset.key, device: place.device, ...(place.axis === "" ? {} : { axis: place.axis }) });
}

/// Whether an axis holds or follows a position at present: a mode of CiA 402 for positions, and operation enabled.
function followsPosition({ device, axis }: Place, signals: readonly Signal[]): boolean {
  const value = (name: string) => signals.find((each) => each.name === `${device}.${axis}.${name}`)?.value ?? 0;
  return [1, 7, 8].includes(value("mode")) && (value("statusword") & 0x6f) === 0x27;
}

/// The axis at which a step of the load shows best: one that follows a position at present, else that of a servo, which answers
/// with a following error that it takes away again.
function loadOf({ offered, signals }: Places): Choosing | undefined {
  const steppers = new Set(offered.filter(({ preset }) => preset.key === "stall").map(({ place }) => place));
  const all = offered.filter(({ preset }) => preset.key === "load");
  return all.find(({ place }) => followsPosition(place, signals)) ?? all.find(({ place }) => !steppers.has(place)) ?? all[0];
}

function tasksOf(places: Places): Task[] {
  const first = places.offered[0]?.place;
  const axis = /\d+$/.exec(first?.axis ?? "")?.[0] ?? "0";
  const load = loadOf(places);
  const device = first?.device ?? places.devices[0]?.name;
  const tasks: (Task | null)[] = [
    {
      title: t("Find why a drive refused"),
      also: "refusal error fault rejected does not switch on abort code",
      steps: t(
        "Events, refusals and faults: each says what came and what was expected, Explain what to do about it. The newest one of a device is on its page as well.",
      ),
      to: href("events", [], { kind: "refusal fault" }),
    },
    device === undefined
      ? null
      : {
          title: t("Move an axis by hand"),
          also: "jog enable turn drive master",
          steps: t("On the page of a device, e.g. {device}: Take control, Enable, then hold an arrow or type a target.", { device }),
          to: href("device", [device]),
        },
    device === undefined
      ? null
      : {
          title: t("Home an axis"),
          also: "homing reference search zero position 6098h",
          steps: t(
            "On the page of a device, e.g. {device}: Take control, Enable the axis, choose where home is, Home. It says “homed” when it is.",
            { device },
          ),
          to: href("device", [device]),
        },
    load === undefined
      ? null
      : {
          title: t("See the following error while the load steps"),
          also: "load step torque lag oscilloscope plot disturbance",
          steps: t(
            "Oscilloscope, preset Load steps: beside the picture, Step puts the load on the axis and takes it off again. The axis has to hold or follow a position, moved by hand or by your master.",
          ),
          to: scopeAt(load),
        },
    {
      title: t("Let an encoder slip"),
      also: "fault inject break coupling sensor",
      steps: t("Faults, encoder-slip: choose the axis, Put it there. The list below leads to what to watch, and clears it."),
      to: href("faults", [], {
        kind: "encoder-slip",
        ...(load === undefined ? {} : { device: load.place.device, axis: /\d+$/.exec(load.place.axis)?.[0] ?? "0" }),
      }),
    },
    {
      title: t("Break something else"),
      also: "fault inject cable wire power stall watchdog",
      steps: t("Faults has every kind with a search; Try a fault on the page of a device has those of that place."),
      to: href("faults"),
    },
    {
      title: t("Record a run and replay it"),
      also: "recording reproduce deterministic replay",
      steps: t(
        "Recording: Restart the rack and record, do what is to be kept, Stop recording. The page then has the command that replays it.",
      ),
      to: href("recording"),
    },
    {
      title: t("Go back to an earlier moment"),
      also: "snapshot restore undo",
      steps: t("Recording, while one runs: keep the present state as a snapshot, and go back to it as often as you like."),
      to: href("recording"),
    },
    {
      title: t("Change a motor"),
      also: "rack file load inertia supply another motor gear",
      steps: t(
        "Rack file, the axis in the list of parts: choose another motor, then Run this. On a device's page, Motor and load at an axis leads there.",
      ),
      to: href("rack-file", [], first === undefined ? {} : { device: first.device, axis }),
    },
    first === undefined
      ? null
      : {
          title: t("Wire a switch"),
          also: "wire limit home switch input output signal connect",
          steps: t(
            "Rack file, wire: from a signal, to the switch, then Run this. Among the inputs on a device's page, Wire to a signal leads there as well.",
          ),
          to: href("rack-file", [], { wire: `${first.device}.${first.axis}.home_switch` }),
        },
    {
      title: t("Save a setup of the oscilloscope"),
      also: "load settings channels trigger keep",
      steps: t(
        "Oscilloscope, above the picture: Save setup writes a file that Load setup takes. The address of the page has the setup as well.",
      ),
      to: href("scope"),
    },
    {
      title: t("Export a picture"),
      also: "png csv screenshot plot image save values",
      steps: t("Oscilloscope, above the picture: Save picture writes a PNG with the names of the channels, Save values a CSV file."),
      to: href("scope"),
    },
    {
      title: t("Write a test"),
      also: "scenario pytest ci regression automate",
      steps: t("Do by hand what the test is to do; Write a test has it as lines that stator test runs."),
      to: href("test"),
    },
    {
      title: t("Connect my own master"),
      also: "SOEM pysoem IgH ethercrab TwinCAT python-canopen PyTrinamic EtherCAT CAN TMCL",
      steps: t("Rack: below each network, Connect has the lines to paste for its link."),
      to: href("rack"),
    },
    {
      title: t("See what is on the wire"),
      also: "frames traffic SDO PDO bytes capture",
      steps: t("Traffic: frames of all networks, decoded; what only repeats is counted in one row."),
      to: href("traffic"),
    },
    device === undefined
      ? null
      : {
          title: t("Read or write an object"),
          also: "object dictionary SDO 6041 parameter register",
          steps: t("On a device's page, Object dictionary: search by index or name, then Write."),
          to: href("device", [device, "objects"]),
        },
  ];
  return tasks.filter((task) => task !== null);
}

function fits({ title, also, steps }: Task, words: string): boolean {
  const text = `${title} ${also} ${steps}`.toLowerCase();
  return words
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
}

export function HowDoIView() {
  const store = useStore();
  const [words, setWords] = useChoice("search");
  const signals = useResource<Signals>("/api/v1/signals");
  const { devices } = store;
  const names = devices.map((device) => device.name).join("\n");
  const offered = useMemo(() => {
    const all = signals.data?.signals ?? [];
    return offeredOf(placesOf(devices, all), all);
  }, [names, signals.data]);
  const known = signals.data !== null || signals.error !== null;
  const all = tasksOf({ devices, offered, signals: signals.data?.signals ?? [] });
  // Not before they lead to the right place.
  const tasks = known ? all.filter((task) => fits(task, words)) : [];
  return (
    <>
      <div class="view-head">
        <h1>{t("How do I …")}</h1>
      </div>
      <section class="panel">
        <header class="toolbar">
          <input
            type="search"
            class="search"
            placeholder={t("What do you want to do?")}
            aria-label={t("What do you want to do?")}
            value={words}
            onInput={(event) => setWords(event.currentTarget.value)}
          />
        </header>
        <ul class="how-do-i">
          {tasks.map((task) => (
            <li key={task.title}>
              <a href={task.to}>{task.title}</a>
              <p class="soft">{task.steps}</p>
            </li>
          ))}
        </ul>
        {known && tasks.length === 0 ? (
          <p class="empty">
            {t("None of the tasks has these words.")}{" "}
            <button type="button" onClick={() => setWords("")}>
              {t("Show all")}
            </button>
          </p>
        ) : null}
      </section>
    </>
  );
}
