import { beforeEach, describe, expect, it } from "vitest";

import { draftOf, keepDraft } from "../src/rack_form/draft";

describe("a draft of the rack file", () => {
  let kept = new Map<string, string>();
  const drafts = {
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, text: string) => void kept.set(key, text),
    removeItem: (key: string) => void kept.delete(key),
  };
  beforeEach(() => {
    kept = new Map();
  });
  it("is kept for its file until it is given up", () => {
    keepDraft("racks/rack.toml", "a = 1", drafts);
    expect(draftOf("racks/rack.toml", drafts)).toBe("a = 1");
    keepDraft("racks/rack.toml", null, drafts);
    expect(draftOf("racks/rack.toml", drafts)).toBeNull();
  });
  it("is none of another file", () => {
    keepDraft("rack.toml", "a = 1", drafts);
    expect(draftOf("rack-2.toml", drafts)).toBeNull();
  });
  it("is none where something else stands, or nothing can be kept", () => {
    keepDraft("rack.toml", "a = 1", drafts);
    for (const key of kept.keys()) {
      kept.set(key, "{");
    }
    expect(draftOf("rack.toml", drafts)).toBeNull();
    const full = {
      ...drafts,
      setItem: () => {
        throw new Error("full");
      },
    };
    expect(() => keepDraft("rack.toml", "a = 1", full)).not.toThrow();
  });
});
