// The text of a rack file in TOML: where its tables and values stand, and changes that leave the rest as it is, comments
// and layout included. What a value means, and whether it may be there, is the program's to say.

export type Path = readonly (string | number)[];

/// A key with its value, alone on its lines or within braces.
export interface Entry {
  readonly path: Path;
  /// Of the value.
  readonly from: number;
  readonly to: number;
  /// Of the whole statement: with its line's end and a comment behind it, or of "key = value" within braces.
  readonly begin: number;
  readonly end: number;
  readonly within: boolean;
}

/// "[a.b]" or "[[a.b]]", and where its last statement ends.
export interface Header {
  readonly path: Path;
  readonly begin: number;
  readonly end: number;
}

export interface Toml {
  readonly text: string;
  readonly entries: readonly Entry[];
  readonly headers: readonly Header[];
}

/// A text that is no TOML, as far as this reader looks.
export class TomlProblem extends Error {
  constructor(readonly offset: number) {
    super(`no TOML at ${offset}`);
    this.name = "TomlProblem";
  }
}

/// "segment[0].device[1].axis", as --set has it.
export function pathText(path: Path): string {
  return path.reduce<string>((text, part) => (typeof part === "number" ? `${text}[${part}]` : text === "" ? part : `${text}.${part}`), "");
}

export function parsePath(text: string): Path {
  return [...text.matchAll(/\[(\d+)\]|[^.[\]]+/g)].map((part) => (part[1] === undefined ? part[0] : Number(part[1])));
}

export function beginsWith(path: Path, start: Path): boolean {
  return start.length <= path.length && start.every((part, i) => path[i] === part);
}

const samePath = (a: Path, b: Path) => a.length === b.length && beginsWith(a, b);

class Reader {
  readonly entries: Entry[] = [];
  readonly headers: { path: Path; begin: number; end: number }[] = [];
  private readonly counts = new Map<string, number>();
  private at = 0;

  constructor(private readonly text: string) {}

  read(): void {
    let table: Path = [];
    for (this.skip(/[\s]*(#[^\n]*\s*)*/y); this.at < this.text.length; this.skip(/[\s]*(#[^\n]*\s*)*/y)) {
      const begin = this.lineBegin();
      if (this.text[this.at] === "[") {
        table = this.header();
        this.endLine();
        this.headers.push({ path: table, begin, end: this.at });
      } else {
        const path = [...table, ...this.keys()];
        this.want("=");
        this.skip(/[ \t]*/y);
        const from = this.at;
        const inside = this.entries.length;
        this.value(path);
        const to = this.at;
        this.endLine();
        this.entries.splice(inside, 0, { path, from, to, begin, end: this.at, within: false });
        const header = this.headers[this.headers.length - 1];
        if (header) {
          header.end = this.at;
        }
      }
    }
  }

  private fail(): never {
    throw new TomlProblem(this.at);
  }

  private skip(what: RegExp): string {
    what.lastIndex = this.at;
    const found = what.exec(this.text)?.[0] ?? "";
    this.at += found.length;
    return found;
  }

  private want(text: string): void {
    this.skip(/[ \t]*/y);
    if (!this.text.startsWith(text, this.at)) {
      this.fail();
    }
    this.at += text.length;
  }

  private lineBegin(): number {
    return this.text.lastIndexOf("\n", this.at - 1) + 1;
  }

  private endLine(): void {
    this.skip(/[ \t]*(#[^\n]*)?\r?/y);
    if (this.at < this.text.length && this.text[this.at] !== "\n") {
      this.fail();
    }
    this.at = Math.min(this.at + 1, this.text.length);
  }

  private key(): string {
    this.skip(/[ \t]*/y);
    const found = this.skip(/[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'/y);
    if (found === "") {
      this.fail();
    }
    this.skip(/[ \t]*/y);
    return contentOf(found);
  }

  private keys(): string[] {
    const all = [this.key()];
    while (this.text[this.at] === ".") {
      ++this.at;
      all.push(this.key());
    }
    return all;
  }

  private header(): Path {
    const array = this.text.startsWith("[[", this.at);
    this.want(array ? "[[" : "[");
    const names = this.keys();
    this.want(array ? "]]" : "]");
    const path: (string | number)[] = [];
    names.forEach((name, i) => {
      path.push(name);
      const place = pathText(path);
      const count = this.counts.get(place);
      if (array && i === names.length - 1) {
        this.counts.set(place, (count ?? 0) + 1);
        path.push(count ?? 0);
      } else if (count !== undefined) {
        path.push(count - 1);
      }
    });
    return path;
  }

  private value(path: Path): void {
    const first = this.text[this.at];
    if (first === "{") {
      this.braces(path);
    } else if (first === "[") {
      this.brackets(path);
    } else if (this.skip(/"""[^]*?(?<!\\)"""|'''[^]*?'''|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[A-Za-z0-9+_.:-]+(?: \d\d:[0-9:.Z+-]+)?/y) === "") {
      this.fail();
    }
  }

  private blank(): void {
    this.skip(/(?:\s|#[^\n]*)*/y);
  }

  private brackets(path: Path): void {
    ++this.at;
    for (let i = 0; ; ++i) {
      this.blank();
      if (this.text[this.at] === "]") {
        break;
      }
      this.value([...path, i]);
      this.blank();
      if (this.text[this.at] === ",") {
        ++this.at;
      } else if (this.text[this.at] !== "]") {
        this.fail();
      }
    }
    ++this.at;
  }

  private braces(path: Path): void {
    ++this.at;
    this.skip(/[ \t]*/y);
    while (this.text[this.at] !== "}") {
      const begin = this.at;
      const inner = [...path, ...this.keys()];
      this.want("=");
      this.skip(/[ \t]*/y);
      const from = this.at;
      this.value(inner);
      this.entries.push({ path: inner, from, to: this.at, begin, end: this.at, within: true });
      this.skip(/[ \t]*/y);
      if (this.text[this.at] === ",") {
        ++this.at;
        this.skip(/[ \t]*/y);
      } else if (this.text[this.at] !== "}") {
        this.fail();
      }
    }
    ++this.at;
  }
}

/// Throws TomlProblem.
export function readToml(text: string): Toml {
  const reader = new Reader(text);
  reader.read();
  return { text, entries: reader.entries, headers: reader.headers };
}

/// What a text in quotes says; anything else as it is written.
export function contentOf(literal: string): string {
  if (literal.startsWith("'")) {
    return literal.replace(/^'''\n?|^'|'''$|'$/g, "");
  }
  if (!literal.startsWith('"')) {
    return literal;
  }
  const inner = literal.replace(/^"""\n?|^"|"""$|"$/g, "");
  const short: Readonly<Record<string, string>> = { n: "\n", t: "\t", r: "\r", b: "\b", f: "\f", e: "\u001b" };
  return inner.replace(/\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|([^]))/g, (_, four?: string, eight?: string, one?: string) => {
    const code = four ?? eight;
    return code === undefined ? (short[one ?? ""] ?? one ?? "") : String.fromCodePoint(parseInt(code, 16));
  });
}

/// A text in quotes.
export function quoted(text: string): string {
  return JSON.stringify(text).replace(/\u007f/g, "\\u007F");
}

const keyText = (key: string | number) => (/^[A-Za-z0-9_-]+$/.test(String(key)) ? String(key) : quoted(String(key)));

/// A table's name in a header: numbers of arrays are not written.
const headerText = (path: Path) =>
  path
    .filter((part) => typeof part === "string")
    .map(keyText)
    .join(".");

export function entryAt(toml: Toml, path: Path): Entry | undefined {
  return toml.entries.find((entry) => samePath(entry.path, path));
}

/// The literal at a path; undefined: there is none.
export function literalAt(toml: Toml, path: Path): string | undefined {
  const entry = entryAt(toml, path);
  return entry && toml.text.slice(entry.from, entry.to);
}

/// Whether anything stands at or below a path.
export function stands(toml: Toml, path: Path): boolean {
  return [...toml.headers, ...toml.entries].some((each) => beginsWith(each.path, path));
}

/// How many tables an array has.
export function countAt(toml: Toml, path: Path): number {
  return [...toml.headers, ...toml.entries].reduce((count, each) => {
    const index = each.path[path.length];
    return beginsWith(each.path, path) && typeof index === "number" ? Math.max(count, index + 1) : count;
  }, 0);
}

/// The keys that stand in a table, in the order of the text.
export function keysAt(toml: Toml, path: Path): string[] {
  const keys = [...toml.headers, ...toml.entries]
    .filter((each) => beginsWith(each.path, path) && typeof each.path[path.length] === "string")
    .sort((a, b) => a.begin - b.begin)
    .map((each) => each.path[path.length] as string);
  return [...new Set(keys)];
}

const spliced = (text: string, from: number, to: number, inserted: string) => text.slice(0, from) + inserted + text.slice(to);

/// In a line of its own, which begins at `at`.
function insertedLines(text: string, at: number, lines: string): string {
  return spliced(text, at, at, `${at > 0 && text[at - 1] !== "\n" ? "\n" : ""}${lines}\n`);
}

/// The text with a value at a path, in its place if there is one, else behind what stands in its table.
export function withValue(toml: Toml, path: Path, literal: string): string {
  const { text } = toml;
  const present = entryAt(toml, path);
  if (present) {
    return spliced(text, present.from, present.to, literal);
  }
  const around = (each: { path: Path }) => each.path.length < path.length && beginsWith(path, each.path);
  const longest = <T extends { path: Path }>(all: readonly T[]) =>
    all.filter(around).reduce<T | undefined>((best, each) => (best && best.path.length >= each.path.length ? best : each), undefined);
  const braces = longest(toml.entries.filter((entry) => text[entry.from] === "{"));
  const line = (host: Path) => `${path.slice(host.length).map(keyText).join(".")} = ${literal}`;
  if (braces) {
    const inner = text.slice(braces.from + 1, braces.to - 1).trim();
    const filled = inner === "" ? line(braces.path) : `${inner}, ${line(braces.path)}`;
    return spliced(text, braces.from, braces.to, `{ ${filled} }`);
  }
  const header = longest(toml.headers);
  if (header) {
    return insertedLines(text, header.end, line(header.path));
  }
  const first = toml.headers[0]?.begin ?? text.length;
  const last = toml.entries.filter((entry) => entry.begin < first).reduce((end, entry) => Math.max(end, entry.end), -1);
  return last >= 0 ? insertedLines(text, last, line([])) : insertedLines(text, first, line([]) + (first < text.length ? "\n" : ""));
}

function withoutRanges(text: string, ranges: readonly { begin: number; end: number }[]): string {
  return [...ranges].sort((a, b) => b.begin - a.begin).reduce((rest, { begin, end }) => spliced(rest, begin, end, ""), text);
}

/// The text without what stands at or below a path.
export function without(toml: Toml, path: Path): string {
  const { text } = toml;
  const headers = toml.headers.filter((header) => beginsWith(header.path, path));
  const inHeader = (entry: Entry) => headers.some((header) => entry.begin >= header.begin && entry.end <= header.end);
  const all = toml.entries.filter((entry) => beginsWith(entry.path, path) && !inHeader(entry));
  const entries = all.filter((entry) => !all.some((outer) => outer !== entry && outer.from <= entry.begin && entry.end <= outer.to));
  const ranges = entries.map((entry) => {
    if (!entry.within) {
      return entry;
    }
    const behind = /^[ \t]*,[ \t]*/.exec(text.slice(entry.end))?.[0].length ?? 0;
    const before = behind > 0 ? 0 : (/,[ \t]*$/.exec(text.slice(0, entry.begin))?.[0].length ?? 0);
    return { begin: entry.begin - before, end: entry.end + behind };
  });
  return withoutRanges(text, [...headers, ...ranges]);
}

/// The text with one more table: in an array if `array`, with `lines` in it. It stands behind those of its array, or behind
/// what belongs to its parent.
export function withTable(toml: Toml, path: Path, array: boolean, lines: readonly string[]): string {
  const behind = (start: Path) =>
    toml.headers.filter((header) => beginsWith(header.path, start)).reduce((end, header) => Math.max(end, header.end), -1);
  let parent = path;
  let at = behind(parent);
  while (at < 0 && parent.length > 0) {
    parent = parent.slice(0, -1);
    at = behind(parent);
  }
  const name = headerText(path);
  return insertedLines(toml.text, at < 0 ? toml.text.length : at, ["", array ? `[[${name}]]` : `[${name}]`, ...lines].join("\n"));
}

/// Where a line begins, counted from 1.
export function lineBegin(text: string, line: number): number {
  let at = 0;
  for (let i = 1; i < line; ++i) {
    const end = text.indexOf("\n", at);
    if (end < 0) {
      return text.length;
    }
    at = end + 1;
  }
  return at;
}

/// Which value a message about a key at a line means; of one that is missing, where it would stand. Null: none.
export function pathAt(toml: Toml, line: number, column: number, key: string): Path | null {
  if (line === 0) {
    return null;
  }
  const begin = lineBegin(toml.text, line);
  const offset = begin + Math.max(column - 1, 0);
  const names = key === "" ? [] : parsePath(key);
  const last = names[names.length - 1];
  const around = toml.entries
    .filter((entry) => entry.begin <= offset && offset < Math.max(entry.end, entry.begin + 1))
    .sort((a, b) => b.path.length - a.path.length);
  for (const entry of around) {
    const at = last === undefined ? entry.path.length - 1 : entry.path.lastIndexOf(last);
    if (at >= 0) {
      return entry.path.slice(0, at + 1);
    }
  }
  const header = toml.headers.find((each) => each.begin <= offset && offset < each.end);
  return header ? [...header.path, ...names] : (around[0]?.path ?? (names.length > 0 ? names : null));
}
