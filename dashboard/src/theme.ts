// Light, dark, or as the system says. The choice is kept for the next visit.

export type Theme = "system" | "light" | "dark";

const kKey = "stator.theme";

export function storedTheme(): Theme {
  const found = localStorage.getItem(kKey);
  return found === "light" || found === "dark" ? found : "system";
}

export function applyTheme(theme: Theme): void {
  if (theme === "system") {
    localStorage.removeItem(kKey);
    delete document.documentElement.dataset["theme"];
  } else {
    localStorage.setItem(kKey, theme);
    document.documentElement.dataset["theme"] = theme;
  }
  // Plots are drawn on canvases, which do not follow CSS by themselves.
  document.dispatchEvent(new CustomEvent("themechange"));
}

/// A colour of the theme as canvases take it, e.g. themeColour("--series-1"). An element resolves it,
/// since the value of a custom property itself would be the text "light-dark(…)".
export function themeColour(name: string): string {
  const probe = document.createElement("span");
  probe.style.color = `var(${name})`;
  probe.hidden = true;
  document.body.append(probe);
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
}
