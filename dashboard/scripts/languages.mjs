// Keeps src/languages/*.json in step with the sentences in the sources.
//
//   npm run languages              adds to each file what it lacks, with "" to be filled in, and takes out what nobody says any more
//   npm run languages -- --check   changes nothing; fails if a file lacks a translation or has one too many, if a translation has
//                                  other places for values than its sentence, or if a text of a page is not given to t()
import { existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";

import { bareTexts, placeOf, sentences, sourceFiles, sources } from "./texts.mjs";

const folder = join(sources, "languages");
const check = process.argv.includes("--check");
const problems = [];

const said = new Map();
for (const file of sourceFiles()) {
  const { found, wrong } = sentences(file);
  for (const node of wrong) {
    problems.push(`${placeOf(node)}: ${node.getText().split("\n")[0]}: a sentence has to stand here as a literal`);
  }
  for (const { key, plural, node } of found) {
    if (said.has(key) && said.get(key) !== plural) {
      problems.push(`${placeOf(node)}: "${key}" is said with and without a number`);
    }
    said.set(key, plural);
  }
  for (const node of bareTexts(file)) {
    problems.push(`${placeOf(node)}: ${node.getText().trim().split("\n")[0]}: give this text to t(), tn() or tx()`);
  }
}
const keys = [...said.keys()].sort((a, b) => (a < b ? -1 : 1));

const places = (text) => [...text.matchAll(/\{(\w+)\}/g)].map(([, name]) => name).sort().join(); // prettier-ignore

/// What is wrong with the translation of a sentence; empty: nothing.
function problemOf(key, translation, categories) {
  const wanted = said.get(key) ? categories : null;
  const texts = wanted === null ? [translation] : categories.map((category) => translation?.[category]);
  if (wanted === null ? typeof translation === "object" : Object.keys(translation ?? {}).some((each) => !categories.includes(each))) {
    return wanted === null ? "needs one text" : `needs texts for ${categories.join(", ")}`;
  }
  if (texts.some((text) => typeof text !== "string" || text === "")) {
    return "has no translation";
  }
  // One of a number may leave the number out ("a cable").
  const wrong = texts.find((text) => places(text) !== places(key) && !(wanted !== null && places(`${text}{count}`) === places(key)));
  return wrong === undefined ? "" : `has other places for values: ${wrong}`;
}

for (const name of readdirSync(folder)
  .filter((each) => each.endsWith(".json"))
  .sort()) {
  const path = join(folder, name);
  const categories = [...new Intl.PluralRules(basename(name, ".json")).resolvedOptions().pluralCategories].sort();
  const present = existsSync(path) ? JSON.parse(readFileSync(path, "utf8")) : {};
  if (check) {
    for (const key of keys) {
      const problem = key in present ? problemOf(key, present[key], categories) : "has no translation";
      if (problem !== "") {
        problems.push(`src/languages/${name}: "${key}" ${problem}`);
      }
    }
    for (const key of Object.keys(present).filter((each) => !said.has(each))) {
      problems.push(`src/languages/${name}: "${key}" is said nowhere`);
    }
  } else {
    const empty = (key) => (said.get(key) ? Object.fromEntries(categories.map((category) => [category, ""])) : "");
    const next = Object.fromEntries(keys.map((key) => [key, present[key] ?? empty(key)]));
    writeFileSync(path, `${JSON.stringify(next, null, 2)}\n`);
    const missing = keys.filter((key) => problemOf(key, next[key], categories) !== "");
    console.log(`${name}: ${keys.length} sentences, ${missing.length} without a translation`);
  }
}

if (problems.length > 0) {
  console.error(problems.join("\n"));
  if (check) {
    console.error(`\n${problems.length} problems. "npm run languages" adds what files lack, to be filled in.`);
  }
  process.exitCode = 1;
}
