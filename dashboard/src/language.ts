// The page's texts in the language of who reads it. The English sentence stands in the program and is the key; what the file of
// a language lacks is shown in English. Whoever imports this waits until the language is there, so that tables may hold texts.
import { createElement, Fragment, type ComponentChildren } from "preact";

/// A text, or one for each number category that the language has where a number stands in it.
type Translation = string | Partial<Record<Intl.LDMLPluralRule, string>>;
type Dictionary = Readonly<Record<string, Translation>>;

const kKey = "stator.language";
const kEnglish = "en";

const files = import.meta.glob<Dictionary>("./languages/*.json", { import: "default" });
const pathOf = (code: string) => `./languages/${code}.json`;

/// Codes of those that there are, English first.
export const languages: readonly string[] = [
  kEnglish,
  ...Object.keys(files)
    .map((path) => /([^/]+)\.json$/.exec(path)?.[1] ?? "")
    .sort(),
];

/// The first of `wanted` that there is, whatever its region; English if there is none.
export function firstKnown(wanted: readonly string[]): string {
  const bases = wanted.map((tag) => tag.toLowerCase().split("-")[0] ?? "");
  return bases.find((base) => languages.includes(base)) ?? kEnglish;
}

const inBrowser = typeof document !== "undefined";

/// The one that the page is in: what a person has chosen before, else what the browser asks for.
export const language: string = inBrowser ? firstKnown([localStorage.getItem(kKey) ?? "", ...navigator.languages]) : kEnglish;

/// Keeps the choice and opens the page anew, in the other language.
export function chooseLanguage(code: string): void {
  localStorage.setItem(kKey, code);
  location.reload();
}

/// As its speakers call it, e.g. "Deutsch".
export function languageName(code: string): string {
  return new Intl.DisplayNames([code], { type: "language" }).of(code) ?? code;
}

async function load(): Promise<Dictionary> {
  if (!inBrowser) {
    return {};
  }
  document.documentElement.lang = language;
  try {
    return (await files[pathOf(language)]?.()) ?? {};
  } catch {
    document.documentElement.lang = kEnglish;
    return {}; // its file does not come through: better an English page than none
  }
}

const dictionary = await load();
const rules = { english: new Intl.PluralRules(kEnglish), own: new Intl.PluralRules(language) };

type Values = Readonly<Record<string, string | number>>;

function textOf(sentence: string): string {
  const found = dictionary[sentence];
  return typeof found === "string" && found !== "" ? found : sentence;
}

function filled(text: string, values: Values): string {
  return text.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}

/// The sentence in the page's language, with `values` in the places of their {names}.
export function t(sentence: string, values: Values = {}): string {
  return filled(textOf(sentence), values);
}

/// A sentence with a number: `one` is the English one of 1, `other`, by which it is found, that of all other numbers. {count} is the
/// number unless `values` says how it is written.
export function tn(count: number, one: string, other: string, values: Values = {}): string {
  const found = dictionary[other];
  const english = rules.english.select(count) === "one" ? one : other;
  const text = typeof found === "object" ? (found[rules.own.select(count)] ?? found.other) : undefined;
  return filled(text === undefined || text === "" ? english : text, { count, ...values });
}

/// The same as `t` where elements stand in the sentence, e.g. links.
export function tx(sentence: string, values: Readonly<Record<string, ComponentChildren>>): ComponentChildren {
  const parts = textOf(sentence).split(/\{(\w+)\}/);
  return createElement(Fragment, null, ...parts.map((part, i): ComponentChildren => (i % 2 === 0 ? part : values[part])));
}
