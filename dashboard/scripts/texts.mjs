// Finds the page's texts in its sources: those that are given to t(), tn() and tx(), and those that are not and ought to be.
import { readdirSync, readFileSync } from "node:fs";
import { join, relative } from "node:path";

import ts from "typescript";

export const sources = new URL("../src", import.meta.url).pathname;

/// Texts in these files are English in every language: they explain events, which the program tells in English, or are made
/// from the program's interface.
const kEnglishFiles = new Set(["api_types.ts", "event_help.ts", "words.ts"]);
/// Names that are the same in every language.
const kNames = new Set(["Stator", "EtherCAT", "kbit/s"]);
/// Elements whose content is for machines.
const kVerbatim = new Set(["code", "kbd", "pre"]);
/// Attributes of elements and properties of components that a person reads.
const kAttributes = new Set([
  "alt", "aria-description", "aria-label", "aria-roledescription", "aria-valuetext", "hint", "label", "outside", "placeholder",
  "summary", "title", "what",
]); // prettier-ignore
/// Of tables: what of an entry a person reads.
const kProperties = new Set(["label", "steps", "summary", "title"]);
const kJoining = new Set(["filter", "join"]);
const kFunctions = new Set(["t", "tn", "tx"]);

/// What has no two small letters in a row is a symbol, an abbreviation or a unit.
export function isWords(text) {
  const plain = text.replace(/\{\w*\}/g, "").trim();
  return /\p{Ll}{2}/u.test(plain) && !kNames.has(plain);
}

export function sourceFiles() {
  return readdirSync(sources, { recursive: true, encoding: "utf8" })
    .filter((path) => /\.tsx?$/.test(path) && !kEnglishFiles.has(path))
    .sort()
    .map((path) => parse(join(sources, path)));
}

export function parse(path, text = readFileSync(path, "utf8")) {
  return ts.createSourceFile(path, text, ts.ScriptTarget.Latest, true, path.endsWith("x") ? ts.ScriptKind.TSX : ts.ScriptKind.TS);
}

export function placeOf(node) {
  const file = node.getSourceFile();
  const { line } = file.getLineAndCharacterOfPosition(node.getStart());
  return `src/${relative(sources, file.fileName)}:${line + 1}`;
}

export function tagOf(element) {
  const tag = ts.isJsxElement(element) ? element.openingElement.tagName : element.tagName;
  return tag.getText();
}

/// The text of a literal with {} for what is put into it; null: it is none.
export function literalText(node) {
  if (ts.isStringLiteral(node) || ts.isNoSubstitutionTemplateLiteral(node)) {
    return node.text;
  }
  return ts.isTemplateExpression(node) ? [node.head.text, ...node.templateSpans.map((span) => span.literal.text)].join("{}") : null;
}

/// What a function gives back.
function* returned(node) {
  if (ts.isArrowFunction(node) && !ts.isBlock(node.body)) {
    yield node.body;
    return;
  }
  const inside = [];
  const visit = (each) => {
    if (ts.isReturnStatement(each) && each.expression) {
      inside.push(each.expression);
    } else if (!ts.isFunctionLike(each)) {
      ts.forEachChild(each, visit);
    }
  };
  ts.forEachChild(node.body, visit);
  yield* inside;
}

const isFunction = (node) => ts.isArrowFunction(node) || ts.isFunctionExpression(node) || ts.isFunctionDeclaration(node);

/// What the names of a file stand for: of constants their values, of functions what they give back; by name alone, so that of two
/// that are called the same in different places both count.
function namesOf(file) {
  const names = { constants: new Map(), functions: new Map() };
  const add = (map, name, expressions) => map.set(name, [...(map.get(name) ?? []), ...expressions]);
  const visit = (node) => {
    if (ts.isFunctionDeclaration(node) && node.name && node.body) {
      add(names.functions, node.name.text, returned(node));
    } else if (ts.isVariableDeclaration(node) && ts.isIdentifier(node.name) && node.initializer) {
      if (isFunction(node.initializer)) {
        add(names.functions, node.name.text, returned(node.initializer));
      } else {
        add(names.constants, node.name.text, [node.initializer]);
      }
    }
    ts.forEachChild(node, visit);
  };
  visit(file);
  return names;
}

/// The literals among what an expression can be, those that are put into a template included. `names` are those of its file;
/// `seen` are the expressions on the way, of which a function that calls itself would make many.
function* results(node, names, seen = new Set()) {
  if (seen.has(node)) {
    return;
  }
  seen.add(node);
  const each = (expression) => results(expression, names, seen);
  if (ts.isParenthesizedExpression(node) || ts.isNonNullExpression(node) || ts.isAsExpression(node)) {
    yield* each(node.expression);
  } else if (ts.isConditionalExpression(node)) {
    yield* each(node.whenTrue);
    yield* each(node.whenFalse);
  } else if (ts.isBinaryExpression(node)) {
    const { kind } = node.operatorToken;
    if ([ts.SyntaxKind.QuestionQuestionToken, ts.SyntaxKind.BarBarToken, ts.SyntaxKind.PlusToken].includes(kind)) {
      yield* each(node.left);
    }
    if (![ts.SyntaxKind.EqualsEqualsEqualsToken, ts.SyntaxKind.ExclamationEqualsEqualsToken].includes(kind)) {
      yield* each(node.right);
    }
  } else if (ts.isArrayLiteralExpression(node)) {
    for (const element of node.elements) {
      yield* each(element);
    }
  } else if (ts.isCallExpression(node) && ts.isPropertyAccessExpression(node.expression) && kJoining.has(node.expression.name.text)) {
    yield* each(node.expression.expression); // "[…].filter(…).join(…)"
  } else if (ts.isCallExpression(node) && ts.isIdentifier(node.expression)) {
    for (const expression of names.functions.get(node.expression.text) ?? []) {
      yield* each(expression);
    }
  } else if (ts.isIdentifier(node)) {
    for (const expression of names.constants.get(node.text) ?? []) {
      yield* each(expression);
    }
  } else if (literalText(node) !== null) {
    yield node;
    if (ts.isTemplateExpression(node)) {
      for (const span of node.templateSpans) {
        yield* each(span.expression);
      }
    }
  }
}

/// Gives `found` each text that is bare: a JsxText, or a literal in an attribute, in what an element contains, in a table.
function look(node, names, found) {
  if (ts.isJsxElement(node) && kVerbatim.has(tagOf(node))) {
    look(node.openingElement, names, found);
    return;
  }
  const expression = (each) => [...results(each, names)].filter((literal) => isWords(literalText(literal))).forEach(found);
  if (ts.isJsxText(node)) {
    if (isWords(node.text)) {
      found(node);
    }
  } else if (ts.isJsxAttribute(node) && node.initializer) {
    const tag = node.parent.parent.tagName.getText();
    const name = node.name.getText();
    if (kAttributes.has(name) || (name === "name" && /^[A-Z]/.test(tag))) {
      expression(ts.isJsxExpression(node.initializer) ? node.initializer.expression : node.initializer);
    }
  } else if (ts.isJsxExpression(node) && node.expression && !ts.isJsxAttribute(node.parent)) {
    expression(node.expression);
  } else if (ts.isPropertyAssignment(node) && kProperties.has(node.name.getText())) {
    expression(node.initializer);
  }
  ts.forEachChild(node, (child) => look(child, names, found));
}

export function bareTexts(file) {
  const all = new Set(); // a constant may be shown at several places
  look(file, namesOf(file), (node) => all.add(node));
  return [...all];
}

/// The sentences that a file gives to t(), tn() and tx(): {key, plural, values, node}, and calls whose sentence is no literal.
export function sentences(file) {
  const found = [];
  const wrong = [];
  const visit = (node) => {
    if (ts.isCallExpression(node) && ts.isIdentifier(node.expression) && kFunctions.has(node.expression.text)) {
      const plural = node.expression.text === "tn";
      const key = node.arguments[plural ? 2 : 0];
      const one = plural ? node.arguments[1] : null;
      if (key && ts.isStringLiteralLike(key) && (one === null || (one && ts.isStringLiteralLike(one)))) {
        found.push({ key: key.text, plural, node });
      } else {
        wrong.push(node);
      }
    }
    ts.forEachChild(node, visit);
  };
  if (!file.fileName.endsWith("/language.ts")) {
    visit(file);
  }
  return { found, wrong };
}
