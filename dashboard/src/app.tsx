import { useEffect, useState } from "preact/hooks";

import type { Api } from "./api";
import { href, parseRoute } from "./router";
import { Scope } from "./scope";

export function App({ api }: { api: Api }) {
  const [route, setRoute] = useState(() => parseRoute(location.hash));
  useEffect(() => {
    const changed = () => setRoute(parseRoute(location.hash));
    window.addEventListener("hashchange", changed);
    return () => window.removeEventListener("hashchange", changed);
  }, []);
  return (
    <div class="shell">
      <header class="top">
        <a class="brand" href={href("rack")}>
          Stator
        </a>
      </header>
      <nav class="nav" aria-label="Views">
        <ul>
          {["rack", "scope"].map((view) => (
            <li key={view}>
              <a href={href(view)} aria-current={route.view === view ? "page" : undefined}>
                {view}
              </a>
            </li>
          ))}
        </ul>
      </nav>
      <main class="main">{route.view === "scope" ? <Scope api={api} /> : <p class="empty">…</p>}</main>
    </div>
  );
}
