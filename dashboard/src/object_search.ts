// Finding entries of a dictionary, and checking what a person wants to write to one.

import type { Declaration } from "./api";
import { t } from "./language";

/// Words may be parts of names, types, units, or an index with or without "0x", "h", ":".
export function searchEntries<E extends Declaration>(entries: readonly E[], text: string): E[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return entries.filter((entry) =>
    words.every((word) => {
      const plain = word.replace(/^0x/, "").replace(/h(?=$|:)/, "");
      const [index = "", subindex] = plain.split(":", 2);
      const address = /^[0-9a-f]{1,4}$/.test(index) && entry.index.toLowerCase().startsWith(index);
      if (address) {
        return subindex === undefined || entry.subindex.toLowerCase().replace(/^0x/, "").endsWith(subindex.replace(/h$/, ""));
      }
      return `${entry.name} ${entry.type} ${entry.unit} ${entry.access}`.toLowerCase().includes(word);
    }),
  );
}

export function isInteger(type: string): boolean {
  return /^(UNSIGNED|INTEGER)\d+$/.test(type);
}

/// Numbers as engineers type them: 12, -5, 0x1F, 1Fh. Nothing: it is no integer.
export function parseInteger(text: string): bigint | null {
  const plain = text
    .trim()
    .replace(/[\s_\u202f]/g, "")
    .replace("−", "-");
  const hex = /^(-?)(?:0x([0-9a-f]+)|([0-9a-f]+)h)$/i.exec(plain);
  if (hex) {
    const size = BigInt(`0x${hex[2] ?? hex[3]}`);
    return hex[1] ? -size : size;
  }
  return /^-?\d+$/.test(plain) ? BigInt(plain) : null;
}

export type Checked = { readonly value: number | string | boolean } | { readonly problem: string };

/// The value to send for what was typed, or why it cannot be one. The server checks the rest.
export function checkValue(entry: Declaration, text: string): Checked {
  if (entry.type === "BOOLEAN") {
    const word = text.trim().toLowerCase();
    if (["1", "true"].includes(word)) return { value: true };
    if (["0", "false"].includes(word)) return { value: false };
    return { problem: t("true or false is needed") };
  }
  if (/^REAL/.test(entry.type)) {
    const value = Number(text);
    return text.trim() !== "" && Number.isFinite(value) ? { value } : { problem: t("a number is needed") };
  }
  if (!isInteger(entry.type)) {
    return { value: text };
  }
  const value = parseInteger(text);
  if (value === null) {
    return { problem: t("an integer is needed, e.g. 12 or 1Fh") };
  }
  const minimum = parseInteger(entry.minimum);
  const maximum = parseInteger(entry.maximum);
  if ((minimum !== null && value < minimum) || (maximum !== null && value > maximum)) {
    return { problem: t("{least} … {most} is possible", { least: entry.minimum, most: entry.maximum }) };
  }
  // JSON's numbers are exact up to 2^53; larger ones go as text.
  return { value: value >= -(2n ** 53n) && value <= 2n ** 53n ? Number(value) : value.toString() };
}

export function writable(entry: Declaration): boolean {
  return entry.access.includes("w");
}
