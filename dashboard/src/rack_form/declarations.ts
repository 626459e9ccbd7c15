// What can stand in a table of a rack file, from the declarations that the program gives as a JSON schema.

import { quoted } from "./toml";

/// As much of a JSON schema as rack files need.
export interface Schema {
  readonly $ref?: string;
  readonly type?: string;
  readonly description?: string;
  readonly default?: unknown;
  readonly minimum?: number;
  readonly maximum?: number;
  readonly enum?: readonly string[];
  readonly const?: string;
  readonly items?: Schema;
  readonly anyOf?: readonly Schema[];
  readonly allOf?: readonly { readonly if?: Schema; readonly then?: Schema & { readonly propertyNames?: Schema } }[];
  readonly properties?: Readonly<Record<string, Schema>>;
  readonly required?: readonly string[];
  readonly additionalProperties?: Schema | boolean;
  readonly definitions?: Readonly<Record<string, Schema>>;
}

/// One key: a value, a table, tables that are numbered, or tables or values with names of one's own.
export interface Member {
  readonly name: string;
  readonly kind: "value" | "table" | "array" | "map";
  /// Of the value, the table, or each that an array or map has.
  readonly schema: Schema;
  readonly help: string;
  readonly needed: boolean;
}

export class Declarations {
  constructor(private readonly root: Schema) {}

  get rack(): Schema {
    return this.root;
  }

  /// What a reference leads to; of alternatives with keys the first, of a list and keys that say more the keys.
  resolve(schema: Schema): Schema {
    let found = schema;
    while (found.$ref !== undefined) {
      const name = found.$ref.replace("#/definitions/", "");
      found = { ...this.root.definitions?.[name], ...(schema.description === undefined ? {} : { description: schema.description }) };
    }
    const parts = found.anyOf?.map((each) => this.resolve(each)) ?? [];
    const first = parts.find((each) => each.type === "object") ?? parts.find((each) => each.type === "array");
    return first && parts.every((each) => each.type === "object" || each.type === "array")
      ? { ...first, description: found.description ?? first.description ?? "" }
      : found;
  }

  /// The keys of a table in the order of their declaration. `given` is what stands in it, e.g. its type, by which it has other
  /// keys.
  members(schema: Schema, given: (name: string) => string | undefined): Member[] {
    const table = this.resolve(schema);
    let names = Object.keys(table.properties ?? {});
    let overrides: Readonly<Record<string, Schema>> = {};
    for (const { if: condition, then } of table.allOf ?? []) {
      const applies = Object.entries(condition?.properties ?? {}).every(([name, { const: value }]) => given(name) === value);
      if (applies && then) {
        names = [...(then.propertyNames ? (this.resolve(then.propertyNames).enum ?? names) : names)];
        overrides = { ...overrides, ...then.properties };
      }
    }
    return names.map((name) =>
      this.member(name, overrides[name] ?? table.properties?.[name] ?? {}, table.required?.includes(name) ?? false),
    );
  }

  private member(name: string, declared: Schema, needed: boolean): Member {
    const schema = this.resolve(declared);
    const member = { name, help: schema.description ?? "", needed };
    if (schema.type === "object") {
      return typeof schema.additionalProperties === "object"
        ? { ...member, kind: "map", schema: this.resolve(schema.additionalProperties) }
        : { ...member, kind: "table", schema };
    }
    const items = schema.items && this.resolve(schema.items);
    return items?.type === "object" ? { ...member, kind: "array", schema: items } : { ...member, kind: "value", schema };
  }
}

function alternatives(schema: Schema): readonly Schema[] {
  return schema.anyOf ?? [schema];
}

/// The words that a value can be; empty: it is no word, or not only one.
export function choicesOf(schema: Schema): readonly string[] {
  return schema.type === "boolean" ? ["true", "false"] : (schema.enum ?? []);
}

/// What a value is when nothing stands there; empty: nothing, or what the device makes of it.
export function defaultOf(schema: Schema): string {
  const value = schema.default;
  return value === undefined ? "" : typeof value === "string" ? value : JSON.stringify(value);
}

const kNumber = /^[+-]?(?:0x[0-9A-Fa-f_]+|0o[0-7_]+|0b[01_]+|\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?)$/;

/// What a person has typed, as TOML writes it. Text that fits nothing is written as a text, of which the program says what
/// is wrong.
export function literalOf(schema: Schema, typed: string): string {
  const text = typed.trim();
  const types = alternatives(schema).map((each) => each.type ?? (each.enum ? "string" : ""));
  if (types.includes("boolean") && (text === "true" || text === "false")) {
    return text;
  }
  if ((types.includes("number") || types.includes("integer")) && kNumber.test(text)) {
    return text;
  }
  const collection = types.includes("array") || types.includes("object");
  return collection && /^[[{][^]*[\]}]$/.test(text) ? text : quoted(typed);
}
