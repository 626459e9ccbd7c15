// Derived channels: expressions over other channels.
//
//   sum     = product { ("+" | "-") product }
//   product = sign { ("*" | "/") sign }
//   sign    = ["-" | "+"] sign | primary
//   primary = number [ "s" | "ms" | "us" ] | channel | function "(" sum { "," sum } ")" | "(" sum ")"
//   channel = letters, digits, "_" and "." or anything in double quotes
import { t, tn } from "../../language";

export class ExpressionError extends Error {
  constructor(
    message: string,
    /// Where in the text, from 0.
    readonly position: number,
  ) {
    super(t("{problem} (at character {position})", { problem: message, position: position + 1 }));
    this.name = "ExpressionError";
  }
}

export type Node =
  | { readonly kind: "number"; readonly value: number; readonly time: boolean }
  | { readonly kind: "channel"; readonly name: string; readonly position: number }
  | { readonly kind: "negate"; readonly operand: Node }
  | { readonly kind: "binary"; readonly operator: "+" | "-" | "*" | "/"; readonly left: Node; readonly right: Node }
  | { readonly kind: "call"; readonly name: FunctionName; readonly operands: readonly Node[] };

interface FunctionDescription {
  readonly operands: number;
  /// The last operand is a constant time.
  readonly span?: boolean;
  readonly summary: string;
}

export const kFunctions = {
  abs: { operands: 1, summary: t("magnitude") },
  sqrt: { operands: 1, summary: t("square root") },
  floor: { operands: 1, summary: t("largest integer that is not above") },
  round: { operands: 1, summary: t("nearest integer") },
  min: { operands: 2, summary: t("the smaller one") },
  max: { operands: 2, summary: t("the larger one") },
  derivative: { operands: 1, summary: t("change per second") },
  integral: { operands: 1, summary: t("sum over time in seconds (trapezoids), from 0 at its first sample") },
  average: { operands: 2, span: true, summary: t("mean of the last so many seconds, e.g. average(x, 10ms)") },
  delta: { operands: 2, span: true, summary: t("change since so many seconds ago, e.g. delta(x, 1ms)") },
} as const satisfies Record<string, FunctionDescription>;

export type FunctionName = keyof typeof kFunctions;

interface Token {
  readonly kind: "number" | "name" | "quoted" | "sign" | "end";
  readonly text: string;
  readonly position: number;
}

const kTokens = /\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|([A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_]+)*)|"([^"]*)"|([-+*/(),]))/y;

function tokensOf(text: string): Token[] {
  const tokens: Token[] = [];
  kTokens.lastIndex = 0;
  let position = 0;
  for (;;) {
    const rest = text.slice(position);
    const start = position + (rest.length - rest.trimStart().length);
    if (start === text.length) {
      tokens.push({ kind: "end", text: "", position: start });
      return tokens;
    }
    kTokens.lastIndex = position;
    const match = kTokens.exec(text);
    if (match === null) {
      throw new ExpressionError(
        text[start] === '"' ? t('a name in quotes has no closing "') : t('"{text}" means nothing here', { text: text[start]! }),
        start,
      );
    }
    const [whole, number, name, quoted, sign] = match;
    const kind = number !== undefined ? "number" : name !== undefined ? "name" : quoted !== undefined ? "quoted" : "sign";
    tokens.push({ kind, text: number ?? name ?? quoted ?? sign ?? "", position: start });
    position += whole.length;
  }
}

const kSeconds: Readonly<Record<string, number>> = { s: 1, ms: 1e-3, us: 1e-6 };

class Parser {
  private next = 0;
  constructor(private readonly tokens: readonly Token[]) {}

  all(): Node {
    const node = this.sum();
    const rest = this.peek();
    if (rest.kind !== "end") {
      throw new ExpressionError(t('"{text}" follows a complete expression; an operator is missing', { text: rest.text }), rest.position);
    }
    return node;
  }

  private peek(): Token {
    return this.tokens[this.next]!;
  }
  private take(): Token {
    return this.tokens[this.next++]!;
  }
  private accept(text: string): boolean {
    const found = this.peek().kind === "sign" && this.peek().text === text;
    this.next += found ? 1 : 0;
    return found;
  }
  private expect(text: string, otherwise: string): void {
    if (!this.accept(text)) {
      throw new ExpressionError(otherwise, this.peek().position);
    }
  }

  private sum(): Node {
    let left = this.product();
    for (;;) {
      const operator = this.accept("+") ? "+" : this.accept("-") ? "-" : null;
      if (operator === null) {
        return left;
      }
      left = { kind: "binary", operator, left, right: this.product() };
    }
  }

  private product(): Node {
    let left = this.sign();
    for (;;) {
      const operator = this.accept("*") ? "*" : this.accept("/") ? "/" : null;
      if (operator === null) {
        return left;
      }
      left = { kind: "binary", operator, left, right: this.sign() };
    }
  }

  private sign(): Node {
    if (this.accept("+")) {
      return this.sign();
    }
    return this.accept("-") ? { kind: "negate", operand: this.sign() } : this.primary();
  }

  private primary(): Node {
    const token = this.take();
    if (token.kind === "number") {
      const unit = this.peek().kind === "name" ? kSeconds[this.peek().text] : undefined;
      if (unit !== undefined) {
        this.take();
      }
      return { kind: "number", value: Number(token.text) * (unit ?? 1), time: unit !== undefined };
    }
    if (token.kind === "quoted") {
      return { kind: "channel", name: token.text, position: token.position };
    }
    if (token.kind === "name") {
      return this.accept("(") ? this.call(token) : { kind: "channel", name: token.text, position: token.position };
    }
    if (token.kind === "sign" && token.text === "(") {
      const node = this.sum();
      this.expect(")", t('")" is missing after "("'));
      return node;
    }
    throw new ExpressionError(
      token.kind === "end"
        ? t("the expression ends where a value is expected")
        : t('"{text}" stands where a value is expected', { text: token.text }),
      token.position,
    );
  }

  private call(token: Token): Node {
    if (!Object.hasOwn(kFunctions, token.text)) {
      throw new ExpressionError(
        t('there is no function "{name}"; there are {all}', { name: token.text, all: Object.keys(kFunctions).join(", ") }),
        token.position,
      );
    }
    const name = token.text as FunctionName;
    const description: FunctionDescription = kFunctions[name];
    const operands: Node[] = [this.sum()];
    while (this.accept(",")) {
      operands.push(this.sum());
    }
    this.expect(")", t('")" is missing after the operands of {name}', { name }));
    if (operands.length !== description.operands) {
      throw new ExpressionError(
        tn(description.operands, "{name} has {count} operand, not {given}", "{name} has {count} operands, not {given}", {
          name,
          given: operands.length,
        }),
        token.position,
      );
    }
    const last = operands[operands.length - 1]!;
    if (description.span && (last.kind !== "number" || !(last.value > 0))) {
      throw new ExpressionError(t("the second operand of {name} is a time, e.g. 10ms", { name }), token.position);
    }
    return { kind: "call", name, operands };
  }
}

export function parseExpression(text: string): Node {
  return new Parser(tokensOf(text)).all();
}

/// All channels that `node` reads, each once.
export function channelsOf(node: Node, found = new Set<string>()): Set<string> {
  switch (node.kind) {
    case "channel":
      found.add(node.name);
      break;
    case "negate":
      channelsOf(node.operand, found);
      break;
    case "binary":
      channelsOf(node.left, found);
      channelsOf(node.right, found);
      break;
    case "call":
      node.operands.forEach((operand) => channelsOf(operand, found));
      break;
    case "number":
      break;
  }
  return found;
}

/// The unit of the result, where it follows; "" where it does not.
export function unitOf(node: Node, unit: (channel: string) => string): string {
  switch (node.kind) {
    case "number":
      return "";
    case "channel":
      return unit(node.name);
    case "negate":
      return unitOf(node.operand, unit);
    case "binary": {
      const left = unitOf(node.left, unit);
      const right = unitOf(node.right, unit);
      if (node.operator === "*" || node.operator === "/") {
        const constant = (side: Node) => side.kind === "number";
        return constant(node.right)
          ? left
          : constant(node.left) && node.operator === "*"
            ? right
            : left === right && node.operator === "/"
              ? ""
              : [left || "1", right || "1"].join(node.operator);
      }
      return left === right || right === "" ? left : left === "" ? right : "";
    }
    case "call": {
      const inner = unitOf(node.operands[0]!, unit);
      switch (node.name) {
        case "derivative":
          return inner === "" ? "1/s" : `${inner}/s`;
        case "integral":
          return inner === "" ? "s" : `${inner} s`;
        case "sqrt":
          return "";
        default:
          return inner;
      }
    }
  }
}
