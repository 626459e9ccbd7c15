import { describe, expect, it } from "vitest";

import { href, parseRoute, takeToken } from "../src/router";

describe("an address", () => {
  it("names the view, its parts and a query", () => {
    const route = parseRoute("#/device/two%20words/objects?search=6041");
    expect(route.view).toBe("device");
    expect(route.parts).toEqual(["two words", "objects"]);
    expect(route.query.get("search")).toBe("6041");
  });
  it("is the rack when it is empty", () => {
    expect(parseRoute("").view).toBe("rack");
    expect(parseRoute("#/").view).toBe("rack");
  });
  it("comes back from href", () => {
    const route = parseRoute(href("device", ["a/b", "objects"], { search: "x y" }));
    expect(route.parts).toEqual(["a/b", "objects"]);
    expect(route.query.get("search")).toBe("x y");
  });
  it("survives what is not encoded properly", () => {
    expect(parseRoute("#/device/100%").parts).toEqual(["100%"]);
  });
});

describe("the token of an address", () => {
  it("is taken out of the fragment", () => {
    expect(takeToken("#token=abc123")).toEqual({ token: "abc123", rest: "" });
    expect(takeToken("#token=abc123&view=/events")).toEqual({ token: "abc123", rest: "#/events" });
  });
  it("is not looked for elsewhere", () => {
    expect(takeToken("#/rack?token=abc")).toBeNull();
  });
});
