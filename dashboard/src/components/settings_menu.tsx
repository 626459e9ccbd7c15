// How the page shows itself to who reads it: colours, units, language. In a menu of the header.
import { useState } from "preact/hooks";

import { chooseLanguage, language, languageName, languages, t } from "../language";
import { kUnits, motionUnit, type MotionUnit } from "../motion_units";
import { chooseUnit } from "../router";
import { applyTheme, storedTheme, type Theme } from "../theme";

const kThemes: readonly [Theme, string][] = [
  ["system", t("System")],
  ["light", t("Light")],
  ["dark", t("Dark")],
];

/// A choice with its name.
function Choice<T extends string>({
  label,
  value,
  choices,
  choose,
}: {
  label: string;
  value: T;
  choices: readonly (readonly [T, string])[];
  choose: (value: T) => void;
}) {
  return (
    <label class="field">
      <span>{label}</span>
      <select value={value} onChange={(event) => choose(event.currentTarget.value as T)}>
        {choices.map(([each, name]) => (
          <option key={each} value={each}>
            {name}
          </option>
        ))}
      </select>
    </label>
  );
}

export function SettingsMenu() {
  const [theme, setTheme] = useState(storedTheme);
  const chooseTheme = (chosen: Theme) => {
    setTheme(chosen);
    applyTheme(chosen);
  };
  return (
    <>
      <button type="button" popovertarget="settings">
        {t("Settings")}
      </button>
      <div id="settings" class="settings" popover="auto" role="group" aria-label={t("Settings")}>
        <Choice label={t("Colours")} value={theme} choices={kThemes} choose={chooseTheme} />
        <Choice<MotionUnit>
          label={t("Positions and velocities in")}
          value={motionUnit.value}
          choices={kUnits.map(({ unit, name }) => [unit, name])}
          choose={chooseUnit}
        />
        <Choice
          label={t("Language")}
          value={language}
          choices={languages.map((code) => [code, languageName(code)])}
          choose={chooseLanguage}
        />
      </div>
    </>
  );
}
