import { useState } from "preact/hooks";

import type { Inputs } from "../api";
import { InputRow } from "../components/input_row";
import { useResource } from "../hooks";

/// An input of the rack beside the picture of what it does.
export function InputsPanel() {
  const { data } = useResource<Inputs>("/api/v1/inputs", 3000);
  const [name, setName] = useState("");
  const inputs = data?.inputs ?? [];
  const chosen = inputs.find((input) => input.name === name);
  return (
    <div class="scope-inputs">
      <label class="field">
        <span>Input</span>
        <select value={name} onChange={(event) => setName(event.currentTarget.value)}>
          <option value="">none</option>
          {inputs.map((input) => (
            <option key={input.name} value={input.name}>
              {input.name}
            </option>
          ))}
        </select>
      </label>
      {chosen === undefined ? null : <InputRow key={chosen.name} input={chosen} label={chosen.name} present={chosen.value} />}
    </div>
  );
}
