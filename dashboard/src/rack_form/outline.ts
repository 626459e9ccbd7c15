// The parts of a rack file that a form shows one at a time, as the text has them.

import { t } from "../language";
import type { Declarations, Member, Schema } from "./declarations";
import { contentOf, countAt, keysAt, literalAt, type Path, type Toml } from "./toml";

export interface Section {
  readonly path: Path;
  readonly title: string;
  readonly depth: number;
  readonly schema: Schema;
}

/// What stands at a key of the table at `path`, without quotes.
export function givenAt(toml: Toml, path: Path): (name: string) => string | undefined {
  return (name) => {
    const literal = literalAt(toml, [...path, name]);
    return literal === undefined ? undefined : contentOf(literal);
  };
}

export function membersAt(toml: Toml, declarations: Declarations, section: { path: Path; schema: Schema }): Member[] {
  return declarations.members(section.schema, givenAt(toml, section.path));
}

function titleOf(toml: Toml, path: Path): string {
  const given = givenAt(toml, path);
  const what = given("type") ?? given("kind") ?? given("action") ?? "";
  const name = given("name") ?? given("link") ?? given("from") ?? "";
  const last = path[path.length - 1];
  const place = typeof last === "number" ? `${path[path.length - 2]} ${last}` : (last ?? "");
  return [name === "" ? place : name, what].filter(Boolean).join(", ");
}

/// The rack itself and every numbered or named table, each behind the one it stands in.
export function sectionsOf(toml: Toml, declarations: Declarations): Section[] {
  const all: Section[] = [];
  const add = (path: Path, schema: Schema, depth: number, title: string) => {
    const section = { path, title, depth, schema };
    all.push(section);
    addBelow(section, path, schema);
  };
  const addBelow = (section: Section, path: Path, schema: Schema) => {
    for (const member of declarations.members(schema, givenAt(toml, path))) {
      const below = [...path, member.name];
      if (member.kind === "array") {
        for (let i = 0; i < countAt(toml, below); ++i) {
          add([...below, i], member.schema, section.depth + 1, titleOf(toml, [...below, i]));
        }
      } else if (member.kind === "map" && member.schema.type === "object") {
        for (const key of keysAt(toml, below)) {
          add([...below, key], member.schema, section.depth + 1, titleOf(toml, [...below, key]));
        }
      } else if (member.kind === "table") {
        addBelow(section, below, member.schema);
      }
    }
  };
  add([], declarations.rack, 0, t("Rack"));
  return all;
}
