// What an event means, what to do about it, and where to look: shown under its sentence.
import type { Event, Objects } from "../api";
import { segment } from "../api";
import { Guide } from "../components/guide";
import { emergencyCode, explainRule, namedObjects } from "../event_help";
import { addressText, hexText } from "../format";
import { useResource, useStore } from "../hooks";
import { t } from "../language";
import { href } from "../router";
import { errorCodeText } from "../words";

export function EventExplanation({ event, id }: { event: Event; id: string }) {
  const store = useStore();
  const help = explainRule(event.rule);
  const code = emergencyCode(event.rule, event.text);
  const device = store.devices.find((each) => each.name === event.device);
  return (
    <div class="explanation" id={id}>
      {help ? (
        <p>
          {help.means} {help.remedy}
        </p>
      ) : null}
      {event.meaning === "" ? null : <p>{event.meaning}.</p>}
      {code === null ? null : <p>{t("Error code {code}: {code2}.", { code: hexText(code, 4), code2: errorCodeText(code) })}</p>}
      <p class="leads">
        {device ? <a href={href("device", [device.name])}>{device.name}</a> : null}
        {device && device.objects > 0 ? <NamedObjects event={event} /> : null}
        {help ? <Guide path={help.guide} /> : null}
      </p>
    </div>
  );
}

/// Those of the event's sentence that the device has.
function NamedObjects({ event }: { event: Event }) {
  const named = namedObjects(event.rule, event.text);
  const declared = useResource<Objects>(named.length > 0 ? `/api/v1/devices/${segment(event.device)}/objects` : null);
  const entries = declared.data?.entries ?? [];
  return (
    <>
      {named.map((address) => {
        const entry = entries.find(
          ({ index, subindex }) =>
            index.toUpperCase() === address.index &&
            (address.subindex === null || Number.parseInt(subindex, 16) === Number.parseInt(address.subindex, 16)),
        );
        if (!entry) {
          return null;
        }
        const text = addressText(address.index, address.subindex ?? undefined);
        return (
          <a key={text} href={href("device", [event.device, "objects"], { search: text })}>
            {t("Object {text} {name}", { text, name: entry.name })}
          </a>
        );
      })}
    </>
  );
}
