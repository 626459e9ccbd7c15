import { describe, expect, it } from "vitest";

import rackFileSchema from "../../docs/rack-file.schema.json";
import { choicesOf, Declarations, defaultOf, literalOf, type Schema } from "../src/rack_form/declarations";
import { sectionOfAxis, withWireTo } from "../src/rack_form/leads";
import { sectionsOf } from "../src/rack_form/outline";
import {
  contentOf,
  countAt,
  keysAt,
  literalAt,
  parsePath,
  pathAt,
  pathText,
  quoted,
  readToml,
  stands,
  TomlProblem,
  without,
  withTable,
  withValue,
} from "../src/rack_form/toml";

const kRack = `# A rack.

[[segment]]
link = "udp:127.0.0.1" # loopback

[[segment.device]]
type = "tmcm-3315"
name = "gantry"

[[segment.device.axis]] # x
motor = "QSH5718-79-30-163"
load.inertia = 4e-5 # kg m²
load.coulomb_friction = 0.03

[[segment.device.axis]]

[[segment.device]]
type = "tmc8670"

[segment.device.objects]
"2030:01" = 1453

[segment.device.axis]
encoder = { counts_per_revolution = 65536, reversed = true }

[[bus]]
ports = [
  "slcan:/tmp/a", # the first
  "slcan:/tmp/b",
]
`;

const gantry = ["segment", 0, "device", 0];
const servo = ["segment", 0, "device", 1];
const literal = (text: string, path: string) => literalAt(readToml(text), parsePath(path));

describe("the text of a rack file", () => {
  it("has its values at paths", () => {
    const toml = readToml(kRack);
    expect(literalAt(toml, [...gantry, "axis", 0, "load", "inertia"])).toBe("4e-5");
    expect(literalAt(toml, [...servo, "objects", "2030:01"])).toBe("1453");
    expect(literalAt(toml, [...servo, "axis", "encoder", "reversed"])).toBe("true");
    expect(literalAt(toml, ["bus", 0, "ports"])).toContain("# the first");
    expect(countAt(toml, [...gantry, "axis"])).toBe(2);
    expect(countAt(toml, ["segment", 0, "device"])).toBe(2);
    expect(keysAt(toml, servo)).toEqual(["type", "objects", "axis"]);
    expect(stands(toml, [...gantry, "axis", 0, "load"])).toBe(true);
    expect(stands(toml, [...gantry, "axis", 1, "load"])).toBe(false);
  });
  it("keeps all else when a value changes", () => {
    const text = withValue(readToml(kRack), [...gantry, "axis", 0, "load", "inertia"], "5e-5");
    expect(text).toBe(kRack.replace("4e-5", "5e-5"));
  });
  it("gets a new value in the table where it belongs", () => {
    const path = [...gantry, "axis", 0, "load", "viscous_friction"];
    const text = withValue(readToml(kRack), path, "1e-4");
    expect(text).toContain("load.coulomb_friction = 0.03\nload.viscous_friction = 1e-4\n");
    expect(literalAt(readToml(text), path)).toBe("1e-4");
    expect(withValue(readToml(kRack), [...gantry, "axis", 1, "motor"], '"m"')).toContain('axis]]\nmotor = "m"\n\n[[segment.device]]\ntype');
    expect(withValue(readToml(kRack), [...servo, "objects", "2030:02"], "7")).toContain('= 1453\n"2030:02" = 7\n');
    expect(withValue(readToml(kRack), [...servo, "axis", "encoder", "offset"], "1")).toContain("reversed = true, offset = 1 }");
    expect(withValue(readToml(kRack), ["clock"], '"real"')).toContain('# A rack.\n\nclock = "real"\n\n[[segment]]');
    expect(withValue(readToml(""), ["clock"], '"real"')).toBe('clock = "real"\n');
    expect(withValue(readToml('clock = "real"'), ["cycle"], '"1ms"')).toBe('clock = "real"\ncycle = "1ms"\n');
  });
  it("loses a value, and nothing else", () => {
    expect(without(readToml(kRack), [...gantry, "axis", 0, "load", "inertia"])).toBe(kRack.replace("load.inertia = 4e-5 # kg m²\n", ""));
    expect(without(readToml(kRack), [...servo, "axis", "encoder", "reversed"])).toContain("{ counts_per_revolution = 65536 }");
    expect(without(readToml(kRack), [...servo, "axis", "encoder", "counts_per_revolution"])).toContain("{ reversed = true }");
  });
  it("gets and loses tables", () => {
    const more = withTable(readToml(kRack), [...gantry, "axis", 2], true, ['motor = "m"']);
    expect(literal(more, "segment[0].device[0].axis[2].motor")).toBe('"m"');
    expect(literal(more, "segment[0].device[1].type")).toBe('"tmc8670"');
    expect(without(readToml(more), [...gantry, "axis", 2]).replace(/\n+/g, "\n")).toBe(kRack.replace(/\n+/g, "\n"));
    const board = withTable(readToml(kRack), [...servo, "board", "my fan"], false, ['type = "dc-motor"']);
    expect(board).toContain('[segment.device.board."my fan"]');
    expect(literalAt(readToml(board), [...servo, "board", "my fan", "type"])).toBe('"dc-motor"');
    const less = without(readToml(kRack), gantry);
    expect(literal(less, "segment[0].device[0].type")).toBe('"tmc8670"');
    expect(countAt(readToml(less), ["segment", 0, "device"])).toBe(1);
    expect(withTable(readToml(""), ["bus", 0], true, [])).toBe("\n[[bus]]\n");
  });
  it("is no TOML at a place", () => {
    for (const text of ["[[segment]", "a = ", "a = 1 b", "a = {b = 1", "a = [1, 2", '"a = 1', "a"]) {
      expect(() => readToml(text), text).toThrow(TomlProblem);
    }
  });
  it("has texts in all quotes", () => {
    expect(contentOf('"a\\"b\\u00e4\\n"')).toBe('a"bä\n');
    expect(contentOf("'C:\\x'")).toBe("C:\\x");
    expect(contentOf('"""\nlong"""')).toBe("long");
    expect(contentOf("4e-5")).toBe("4e-5");
    for (const text of ['a"b', "C:\\x", "ä\n\t"]) {
      expect(contentOf(quoted(text))).toBe(text);
    }
  });
  it("is reproduced whatever is written into it", () => {
    // Each value replaced by itself, taken out and put back is the same tree.
    const toml = readToml(kRack);
    for (const { path, from, to } of toml.entries) {
      const value = kRack.slice(from, to);
      expect(withValue(toml, path, value), pathText(path)).toBe(kRack);
      expect(literalAt(readToml(withValue(readToml(without(toml, path)), path, value)), path), pathText(path)).toBe(value);
    }
  });
});

describe("a message of the program", () => {
  const toml = readToml(kRack);
  const line = (part: string) => kRack.slice(0, kRack.indexOf(part)).split("\n").length;
  it("is about the value at its line", () => {
    expect(pathText(pathAt(toml, line("load.inertia"), 16, "inertia")!)).toBe("segment[0].device[0].axis[0].load.inertia");
    expect(pathText(pathAt(toml, line("load.inertia"), 1, "load")!)).toBe("segment[0].device[0].axis[0].load");
    expect(pathText(pathAt(toml, line("encoder"), 44, "reversed")!)).toBe("segment[0].device[1].axis.encoder.reversed");
  });
  it("is about a key that is missing in a table", () => {
    expect(pathText(pathAt(toml, line("[[bus]]"), 1, "device")!)).toBe("bus[0].device");
    expect(pathText(pathAt(toml, line("[[bus]]"), 1, "")!)).toBe("bus[0]");
  });
  it("may be about no place", () => {
    expect(pathAt(toml, 0, 0, "")).toBeNull();
  });
});

const schema = rackFileSchema as unknown as Schema;
const declarations = new Declarations(schema);

describe("what is declared", () => {
  it("has a part for each table of the rack file", () => {
    const sections = sectionsOf(readToml(kRack), declarations);
    expect(sections.map((each) => `${"-".repeat(each.depth)}${each.title}`)).toEqual([
      "Rack",
      "-udp:127.0.0.1",
      "--gantry, tmcm-3315",
      "---axis 0",
      "---axis 1",
      "--device 1, tmc8670",
      "-bus 0",
    ]);
  });
  it("depends on the type of a device", () => {
    const device = declarations.members(schema, () => undefined).find((each) => each.name === "segment")!.schema.properties!["device"]!;
    const of = (type: string) => declarations.members(declarations.resolve(device.items!), (name) => (name === "type" ? type : undefined));
    expect(of("tmcm-3315").find((each) => each.name === "axis")?.kind).toBe("array");
    expect(of("tmc8670").find((each) => each.name === "axis")?.kind).toBe("table");
    expect(of("tmc8670").find((each) => each.name === "objects")?.kind).toBe("map");
    expect(of("junction").map((each) => each.name)).not.toContain("axis");
    expect(of("tmcm-3315").find((each) => each.name === "type")?.needed).toBe(true);
  });
  it("shows every key that is declared anywhere", () => {
    const declared = new Set<string>();
    const collect = (part: unknown) => {
      if (typeof part === "object" && part !== null) {
        for (const [name, value] of Object.entries(part)) {
          if (name === "properties") {
            Object.keys(value as object).forEach((key) => declared.add(key));
          }
          if (name !== "if") {
            collect(name === "properties" ? Object.values(value as object) : value);
          }
        }
      }
    };
    collect(rackFileSchema);
    const shown = new Set<string>();
    const walk = (table: Schema, given: (name: string) => string | undefined) => {
      for (const member of declarations.members(table, given)) {
        shown.add(member.name);
        if (member.kind !== "value") {
          const types = member.schema.properties?.["type"] ?? member.schema.properties?.["kind"];
          (types?.enum ?? [""]).forEach((type) => walk(member.schema, (name) => (["type", "kind"].includes(name) ? type : undefined)));
        }
      }
    };
    walk(schema, () => undefined);
    expect([...declared].filter((name) => !shown.has(name))).toEqual([]);
    expect(shown.size).toBeGreaterThan(300);
  });
  it("says what stands where nothing does, and which words can", () => {
    expect(defaultOf({ default: 24 })).toBe("24");
    expect(defaultOf({ default: "real" })).toBe("real");
    expect(defaultOf({ default: ["*"] })).toBe('["*"]');
    expect(choicesOf({ type: "boolean" })).toEqual(["true", "false"]);
    expect(choicesOf({ enum: ["a", "b"] })).toEqual(["a", "b"]);
  });
  it("writes what was typed as TOML does", () => {
    expect(literalOf({ type: "number" }, " 4e-5 ")).toBe("4e-5");
    expect(literalOf({ type: "integer" }, "0x10")).toBe("0x10");
    expect(literalOf({ type: "number" }, "much")).toBe('"much"');
    expect(literalOf({ type: "boolean" }, "true")).toBe("true");
    expect(literalOf({ enum: ["a"] }, "a")).toBe('"a"');
    expect(literalOf({ type: "string" }, "5")).toBe('"5"');
    expect(literalOf({ anyOf: [{ type: "integer" }, { enum: ["unlimited"] }] }, "unlimited")).toBe('"unlimited"');
    expect(literalOf({ anyOf: [{ type: "integer" }, { enum: ["unlimited"] }] }, "500")).toBe("500");
    expect(literalOf({ type: "array" }, '["a"]')).toBe('["a"]');
    expect(literalOf({ type: "array" }, "a")).toBe('"a"');
  });
});

describe("links from other views", () => {
  it("lead to an axis, to its device where it has no part of its own, and nowhere if there is no such device", () => {
    const toml = readToml(kRack);
    const sections = sectionsOf(toml, new Declarations(rackFileSchema as Schema));
    const place = (device: string, axis: number) => {
      const found = sectionOfAxis(toml, sections, device, axis);
      return found && pathText(found.path);
    };
    expect(place("gantry", 1)).toBe("segment[0].device[0].axis[1]");
    expect(place("gantry", 7)).toBe("segment[0].device[0]");
    expect(place("tmc8670", 0)).toBe("segment[0].device[1]");
    expect(place("nobody", 0)).toBeUndefined();
  });
  it("begin a wire to an input, once", () => {
    const { text, path } = withWireTo(readToml(kRack), "gantry.axis0.home_switch");
    expect(pathText(path)).toBe("wire[0]");
    expect(text.slice(kRack.length)).toBe('\n[[wire]]\nfrom = ""\nto = "gantry.axis0.home_switch"\n');
    expect(withWireTo(readToml(text), "gantry.axis0.home_switch")).toEqual({ text, path });
    expect(pathText(withWireTo(readToml(text), "gantry.axis1.home_switch").path)).toBe("wire[1]");
  });
});
