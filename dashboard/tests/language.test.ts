import { describe, expect, it } from "vitest";

import { firstKnown, language, languages, t, tn } from "../src/language";

describe("a language", () => {
  it("is the first that there is, whatever its region", () => {
    expect(languages).toContain("de");
    expect(firstKnown(["", "de-AT", "en"])).toBe("de");
    expect(firstKnown(["tlh", "EN-gb", "de"])).toBe("en");
    expect(firstKnown(["tlh"])).toBe("en");
    expect(language).toBe("en"); // without a browser
  });
});

describe("a sentence", () => {
  it("has values in the places of their names", () => {
    expect(t("Clear fault {id}", { id: 7 })).toBe("Clear fault 7");
    expect(t("{id} {other}", { id: "{other}" })).toBe("{other} {other}");
  });
  it("with a number is that of the number", () => {
    const cables = (count: number) => tn(count, "{count} cable broken", "{count} cables broken");
    expect([cables(0), cables(1), cables(2)]).toEqual(["0 cables broken", "1 cable broken", "2 cables broken"]);
    expect(tn(1200, "{count} row", "{count} rows", { count: "1 200" })).toBe("1 200 rows");
  });
});
