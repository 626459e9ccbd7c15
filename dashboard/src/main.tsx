import "./styles/theme.css";
import "./styles/base.css";
import "./styles/shell.css";

import { Component, render } from "preact";

import { Api } from "./api";
import { App } from "./app";
import { followUnit, takeToken } from "./router";
import { applyTheme, storedTheme } from "./theme";
import "./styles/narrow.css";

// Signals leave a component alone that has state of its own and the same properties; the oscilloscope's are drawn from an object
// that changes in place.
delete Component.prototype.shouldComponentUpdate;

const api = new Api();
const taken = takeToken(location.hash);
if (taken) {
  api.token = taken.token;
  history.replaceState(null, "", location.pathname + location.search + taken.rest);
}
followUnit();
applyTheme(storedTheme());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => applyTheme(storedTheme()));

const root = document.getElementById("root");
if (root) {
  render(<App api={api} />, root);
}
