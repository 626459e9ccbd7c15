import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";

import type { Api } from "./api";
import { SettingsMenu } from "./components/settings_menu";
import { TokenDialog } from "./components/token_dialog";
import { timeText } from "./format";
import { useStore, useWorld, WorldContext } from "./hooks";
import icon from "./icon.svg";
import { Journal } from "./journal";
import { t, tx } from "./language";
import { SignalHub } from "./live";
import { followUnit, href, parseRoute, type Route } from "./router";
import { Scope } from "./scope";
import { RackStore } from "./store";
import { DeviceView } from "./views/device";
import { EventsView } from "./views/events";
import { FaultsView } from "./views/faults";
import { HowDoIView } from "./views/how_do_i";
import { RackView } from "./views/rack";
import { RackFileView } from "./views/rack_file";
import { RecordingView } from "./views/recording";
import { TrafficView } from "./views/traffic";
import { WriteTestView } from "./views/write_test";

interface ViewDeclaration {
  readonly view: string;
  readonly title: string;
  /// The route of the server it lives on.
  readonly needs: string;
}

const kViews: readonly ViewDeclaration[] = [
  { view: "rack", title: t("Rack"), needs: "/api/v1/rack" },
  { view: "how", title: t("How do I …"), needs: "/api/v1/rack" },
  { view: "rack-file", title: t("Rack file"), needs: "/api/v1/rack/file" },
  { view: "scope", title: t("Oscilloscope"), needs: "/api/v1/signals" },
  { view: "events", title: t("Events"), needs: "/api/v1/events" },
  { view: "traffic", title: t("Traffic"), needs: "/api/v1/traffic" },
  { view: "faults", title: t("Faults"), needs: "/api/v1/faults/kinds" },
  { view: "recording", title: t("Recording"), needs: "/api/v1/recording" },
  { view: "test", title: t("Write a test"), needs: "/api/v1/rack" },
];

export function App({ api }: { api: Api }) {
  const world = useMemo(() => ({ api, store: new RackStore(api), hub: new SignalHub(api), journal: new Journal(api) }), [api]);
  useEffect(() => {
    const unsubscribe = world.store.subscribe(() => world.store.rack && world.journal.follow(world.store.rack.run));
    world.store.start();
    return () => {
      unsubscribe();
      world.store.stop();
    };
  }, [world]);
  return (
    <WorldContext.Provider value={world}>
      <Shell />
    </WorldContext.Provider>
  );
}

function useRoute(): Route {
  const [route, setRoute] = useState(() => parseRoute(location.hash));
  useEffect(() => {
    const changed = () => {
      followUnit();
      setRoute(parseRoute(location.hash));
    };
    window.addEventListener("hashchange", changed);
    return () => window.removeEventListener("hashchange", changed);
  }, []);
  return route;
}

const kConnectionText = {
  connecting: t("connecting"),
  online: t("running"),
  lost: t("no connection"),
  locked: t("token needed"),
};

function Shell() {
  const store = useStore();
  const { api } = useWorld();
  const route = useRoute();
  const main = useRef<HTMLElement>(null);
  const [asking, setAsking] = useState(false);
  useEffect(() => {
    const wanted = () => setAsking(true);
    document.addEventListener("tokenwanted", wanted);
    return () => document.removeEventListener("tokenwanted", wanted);
  }, []);
  useEffect(() => {
    if (store.connection === "locked") {
      setAsking(true);
    }
  }, [store.connection]);
  const title = kViews.find((each) => each.view === route.view)?.title ?? route.parts[0] ?? "";
  useEffect(() => {
    document.title = title === "" ? "Stator" : `${title} – Stator`;
  }, [title]);
  const refusals = store.events.filter((event) => event.severity === "refusal" || event.severity === "fault").length;
  const { rack } = store;
  return (
    <div class="shell">
      <a
        class="skip"
        href="#main"
        onClick={(event) => {
          event.preventDefault();
          main.current?.focus();
        }}
      >
        {t("Skip to the content")}
      </a>
      <header class="top">
        <a class="brand" href={href("rack")}>
          <img src={icon} alt="" width="22" height="22" />
          Stator
        </a>
        <span class={`connection ${store.connection}`} role="status">
          {kConnectionText[store.connection]}
        </span>
        <dl>
          <div title={t("Simulated time since power-on")}>
            <dt>{t("Time")}</dt>
            <dd class="clock">{rack ? timeText(rack.time_ns, 1) : "–"}</dd>
          </div>
          <div title={t("real: the machine's time; lockstep: time moves with the master")}>
            <dt>{t("Clock")}</dt>
            <dd>{rack?.clock ?? "–"}</dd>
          </div>
        </dl>
        <span class="spacer" />
        <button type="button" onClick={() => setAsking(true)} title={t("Changes need the token that stator run printed")}>
          {api.token === "" ? t("Read only") : t("Token set")}
        </button>
        <SettingsMenu />
      </header>
      <nav class="nav" aria-label={t("Views")}>
        <ul>
          {kViews.map(({ view, title: name, needs }) =>
            view === "rack" || store.offers(needs) ? (
              <NavLink key={view} to={href(view)} current={route.view === view}>
                <span class="name">{name}</span>
                {view === "events" && refusals > 0 ? (
                  <span class="badge" title={t("Refusals and faults")}>
                    {refusals > 999 ? "999+" : refusals}
                  </span>
                ) : null}
              </NavLink>
            ) : null,
          )}
        </ul>
        <h2>{t("Devices")}</h2>
        <ul>
          {store.devices.map((device) => (
            <NavLink
              key={device.name}
              to={href("device", [device.name])}
              current={route.view === "device" && route.parts[0] === device.name}
            >
              <span class="name">{device.name}</span>
              {device.powered ? null : <span class="badge warning">{t("off")}</span>}
            </NavLink>
          ))}
        </ul>
      </nav>
      <main class="main" id="main" ref={main} tabIndex={-1}>
        {store.connection === "lost" ? (
          <p class="notice bad lost" role="alert">
            {tx("The rack cannot be reached. What is shown is old; the page goes on by itself when {code} is back at {host}.", {
              code: <code>stator run</code>,
              host: location.host,
            })}
          </p>
        ) : null}
        {store.connection === "connecting" || (rack === null && store.connection === "lost") ? (
          <p class="empty">{store.connection === "lost" ? "" : t("Connecting …")}</p>
        ) : store.connection === "locked" ? (
          <p class="empty">{t("This server is open to other machines, so everything needs its token.")}</p>
        ) : (
          <View key={`${store.epoch} ${route.view} ${route.parts[0] ?? ""}`} route={route} />
        )}
      </main>
      <TokenDialog open={asking} onClose={() => setAsking(false)} />
    </div>
  );
}

function NavLink({ to, current, children }: { to: string; current: boolean; children: ComponentChildren }) {
  return (
    <li>
      <a href={to} aria-current={current ? "page" : undefined}>
        {children}
      </a>
    </li>
  );
}

function View({ route }: { route: Route }) {
  const store = useStore();
  const { api } = useWorld();
  const declared = kViews.find((each) => each.view === route.view);
  if (declared && !store.offers(declared.needs)) {
    return <p class="empty">{t("{title}: not offered by this server.", { title: declared.title })}</p>;
  }
  switch (route.view) {
    case "rack":
      return <RackView />;
    case "how":
      return <HowDoIView />;
    case "rack-file":
      return <RackFileView />;
    case "scope":
      return <Scope api={api} query={route.query} />;
    case "events":
      return <EventsView />;
    case "traffic":
      return <TrafficView />;
    case "faults":
      return <FaultsView />;
    case "recording":
      return <RecordingView />;
    case "test":
      return <WriteTestView />;
    case "device":
      return <DeviceView name={route.parts[0] ?? ""} tab={route.parts[1] ?? ""} />;
    default:
      return <p class="empty">{tx("There is no such view. {link}", { link: <a href={href("rack")}>{t("To the rack")}</a> })}</p>;
  }
}
