import { unitText } from "../format";
import { useStore } from "../hooks";
import { t, tn } from "../language";
import { seconds } from "./core/csv";
import type { Event } from "../api_types";
import { kSeverities, type TriggerSettings, type TriggerSource } from "./core/trigger";
import { NumberField } from "./number_field";
import type { Oscilloscope } from "./oscilloscope";

function sourceOf(kind: TriggerSource["kind"], channel: string): TriggerSource {
  switch (kind) {
    case "level":
      return { kind, channel, level: 0, hysteresis: 0, edge: "rising" };
    case "state":
      return { kind, channel, mask: null, value: null };
    case "event":
      return { kind, severity: "fault", device: "", rule: "" };
    case "none":
      return { kind };
  }
}

/// What starts a picture.
export function TriggerPanel({ scope, attempt }: { scope: Oscilloscope; attempt: (action: () => void) => void }) {
  const store = useStore();
  const { trigger, channels } = scope.setup;
  const { source } = trigger;
  const compared = channels.find(({ name }) => "channel" in source && name === source.channel);
  const level = compared ? scope.display(compared) : { unit: "", factor: 1 };
  const change = (patch: Partial<TriggerSettings>) => attempt(() => scope.change({ trigger: { ...trigger, ...patch } }));
  const channelField = (present: string, set: (channel: string) => void) => (
    <label class="field wide">
      <span>{t("Channel")}</span>
      <select value={present} onChange={(event) => set(event.currentTarget.value)}>
        {channels.some(({ name }) => name === present) ? null : <option value={present}>{present || t("none")}</option>}
        {channels.map(({ name }) => (
          <option key={name} value={name}>
            {name}
          </option>
        ))}
      </select>
    </label>
  );
  return (
    <div class="scope-form">
      <label class="field">
        <span>{t("Trigger on")}</span>
        <select
          value={source.kind}
          onChange={(event) =>
            change({
              source: sourceOf(
                event.currentTarget.value as TriggerSource["kind"],
                "channel" in source ? source.channel : (channels[0]?.name ?? ""),
              ),
            })
          }
        >
          <option value="none">{t("nothing")}</option>
          <option value="level">{t("level")}</option>
          <option value="state">{t("state change")}</option>
          <option value="event">{t("event or fault")}</option>
        </select>
      </label>
      {source.kind === "level" ? (
        <>
          {channelField(source.channel, (channel) => change({ source: { ...source, channel } }))}
          <label class="field">
            <span>{t("Edge")}</span>
            <select
              value={source.edge}
              onChange={(event) => change({ source: { ...source, edge: event.currentTarget.value as "rising" | "falling" | "either" } })}
            >
              <option value="rising">{t("rising")}</option>
              <option value="falling">{t("falling")}</option>
              <option value="either">{t("either")}</option>
            </select>
          </label>
          <NumberField
            label={t("Level")}
            unit={unitText(level.unit)}
            value={source.level * level.factor}
            onValue={(value) => change({ source: { ...source, level: (value ?? 0) / level.factor } })}
          />
          <NumberField
            label={t("Hysteresis")}
            minimum={0}
            value={source.hysteresis * level.factor}
            onValue={(value) => change({ source: { ...source, hysteresis: (value ?? 0) / level.factor } })}
          />
        </>
      ) : null}
      {source.kind === "state" ? (
        <>
          {channelField(source.channel, (channel) => change({ source: { ...source, channel } }))}
          <NumberField
            label={t("Bits that count (mask)")}
            optional
            placeholder={t("all")}
            minimum={0}
            value={source.mask}
            onValue={(mask) => change({ source: { ...source, mask } })}
          />
          <NumberField
            label={t("Into state")}
            optional
            placeholder={t("any")}
            value={source.value}
            onValue={(value) => change({ source: { ...source, value } })}
          />
        </>
      ) : null}
      {source.kind === "event" ? (
        <>
          <label class="field">
            <span>{t("At least")}</span>
            <select
              value={source.severity}
              onChange={(event) => change({ source: { ...source, severity: event.currentTarget.value as Event["severity"] } })}
            >
              {kSeverities.map((each) => (
                <option key={each} value={each}>
                  {each}
                </option>
              ))}
            </select>
          </label>
          <label class="field">
            <span>{t("Device")}</span>
            <select value={source.device} onChange={(event) => change({ source: { ...source, device: event.currentTarget.value } })}>
              <option value="">{t("any")}</option>
              {store.devices.map(({ name }) => (
                <option key={name} value={name}>
                  {name}
                </option>
              ))}
            </select>
          </label>
          <label class="field">
            <span>{t("Rule")}</span>
            <input
              value={source.rule}
              placeholder={t("any")}
              onChange={(event) => change({ source: { ...source, rule: event.currentTarget.value.trim() } })}
            />
          </label>
        </>
      ) : null}
      {source.kind === "none" ? null : (
        <>
          <label class="field">
            <span>{t("Shown before the trigger: {value} %", { value: Math.round(trigger.before * 100) })}</span>
            <input
              type="range"
              min="0"
              max="100"
              value={Math.round(trigger.before * 100)}
              onInput={(event) => change({ before: Number(event.currentTarget.value) / 100 })}
            />
          </label>
          <NumberField
            label={t("Hold-off")}
            unit="s"
            minimum={0}
            value={trigger.holdOff * 1e-9}
            onValue={(value) => change({ holdOff: (value ?? 0) * 1e9 })}
          />
          <p class="soft wide">
            {scope.acquisition.frame === null
              ? tn(scope.acquisition.count, "{count} trigger", "{count} triggers")
              : tn(scope.acquisition.count, "{count} trigger, at {time} s", "{count} triggers, the last at {time} s", {
                  time: seconds(scope.acquisition.frame.trigger),
                })}
          </p>
        </>
      )}
    </div>
  );
}
