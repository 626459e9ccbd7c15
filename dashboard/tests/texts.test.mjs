// Texts that are given to nobody who translates them are found wherever they come from.
import { describe, expect, it } from "vitest";

import { bareTexts, parse } from "../scripts/texts.mjs";

const bare = (source) => bareTexts(parse("/view.tsx", source)).map((node) => node.getText());

describe("a text that is not given to t()", () => {
  it("is found in what an element contains and in its attributes", () => {
    expect(bare("<p>Some words</p>")).toEqual(["Some words"]);
    expect(bare('<p title={given ? "One thing" : t("Another")} />')).toEqual(['"One thing"']);
    expect(bare("<p>{`Fault ${id} is put`}</p>")).toEqual(["`Fault ${id} is put`"]);
    expect(bare("<p>{t(`no matter`)}</p>")).toEqual([]);
  });
  it("is found in what is put into a template", () => {
    expect(bare('<p aria-label={`${name}: ${on ? "switched on" : t("switched off")}`} />')).toEqual(['"switched on"']);
  });
  it("is found behind the name of a constant, once", () => {
    expect(bare("const label = `Fault at ${name}`; <p title={label}>{label}</p>")).toEqual(["`Fault at ${name}`"]);
    expect(bare("const key = `of ${name}`; <p class={key} id={key} />")).toEqual([]);
  });
  it("is found in what a function gives back, though the function calls itself", () => {
    expect(bare('const say = (n) => (n > 0 ? say(n - 1) : "at its end"); <p>{say(3)}</p>')).toEqual(['"at its end"']);
    expect(bare('function say(n) { if (n) { return "more"; } return other(() => "inner"); } <p>{say(3)}</p>')).toEqual(['"more"']);
  });
});
