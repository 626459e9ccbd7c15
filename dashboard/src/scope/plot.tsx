import { useEffect, useRef, useState } from "preact/hooks";

import { t } from "../language";
import type { Oscilloscope } from "./oscilloscope";
import { Picture, readColours } from "./picture";
import { Pointing } from "./pointing";

/// The picture: drawn in the browser's rhythm, and only when something has changed.
export function Plot({ scope, onPicture }: { scope: Oscilloscope; onPicture: (picture: Picture) => void }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const box = useRef<HTMLDivElement>(null);
  const [said, setSaid] = useState("");
  useEffect(() => {
    const picture = new Picture(canvas.current!, scope);
    const pointing = new Pointing(scope, picture, box.current!, setSaid);
    onPicture(picture);
    let drawn = -1;
    let size = "";
    let request = 0;
    const frame = (now: number) => {
      request = requestAnimationFrame(frame);
      scope.tick(now);
      const present = `${picture.canvas.clientWidth} ${picture.canvas.clientHeight} ${window.devicePixelRatio}`;
      if (scope.revision !== drawn || present !== size) {
        drawn = scope.revision;
        size = present;
        picture.draw();
      }
    };
    request = requestAnimationFrame(frame);
    const recolour = () => {
      picture.colours = readColours();
      drawn = -1;
    };
    const dark = matchMedia("(prefers-color-scheme: dark)");
    document.addEventListener("themechange", recolour);
    dark.addEventListener("change", recolour);
    return () => {
      cancelAnimationFrame(request);
      pointing.detach();
      document.removeEventListener("themechange", recolour);
      dark.removeEventListener("change", recolour);
    };
  }, [scope]);
  return (
    <div class="scope-plot">
      <canvas
        ref={canvas}
        tabIndex={0}
        role="application"
        aria-label={t("Signals over time")}
        aria-roledescription={t("oscilloscope")}
        aria-describedby="scope-keys"
      />
      <div ref={box} class="zoom-box" hidden />
      <p id="scope-keys" class="hidden-text">
        {t(
          "Arrow keys and Page Up, Page Down move the picture, plus and minus zoom, Home follows the newest samples again, less-than and greater-than change the shown time, space runs and stops, S records a single trigger, T forces one, A, B, C and D choose a cursor that the arrow keys then move.",
        )}
      </p>
      <p class="hidden-text" aria-live="polite">
        {said}
      </p>
    </div>
  );
}
