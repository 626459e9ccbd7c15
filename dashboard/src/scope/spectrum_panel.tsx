import { useEffect, useRef, useState } from "preact/hooks";

import { unitText } from "../format";
import { t } from "../language";
import { type WindowName, decibels, kWindows } from "./core/fft";
import { frequencyText, numberText } from "./core/numbers";
import type { SpectrumSetup } from "./core/setup";
import type { Oscilloscope } from "./oscilloscope";
import { type Picture, seriesColour } from "./picture";
import { type ChannelSpectrum, drawSpectra, spectraOf } from "./spectrum_picture";

const kEvery = 250; // ms

/// Spectra of the visible channels, of what is shown or lies between the time cursors.
export function SpectrumPanel({
  scope,
  picture,
  attempt,
}: {
  scope: Oscilloscope;
  picture: Picture;
  attempt: (action: () => void) => void;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [spectra, setSpectra] = useState<ChannelSpectrum[]>([]);
  const { spectrum, channels, period } = scope.setup;
  const change = (patch: Partial<SpectrumSetup>) => attempt(() => scope.change({ spectrum: { ...spectrum, ...patch } }));
  useEffect(() => {
    let done = -1;
    const draw = () => {
      if (scope.revision !== done && canvas.current !== null && !document.hidden) {
        const found = spectraOf(scope);
        drawSpectra(canvas.current, picture.colours, found, scope.setup.spectrum.decibels, 0.5e9 / scope.setup.period);
        setSpectra(found);
        done = scope.revision;
      }
    };
    draw();
    const timer = setInterval(draw, kEvery);
    return () => clearInterval(timer);
  }, [scope, picture, spectrum, period]);
  const first = spectra[0];
  return (
    <section class="panel scope-spectrum" aria-label={t("Spectrum")}>
      <header>
        <h2>{t("Spectrum")}</h2>
        <label>
          {t("Window")}{" "}
          <select value={spectrum.window} onChange={(event) => change({ window: event.currentTarget.value as WindowName })}>
            {Object.keys(kWindows).map((name) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        </label>
        <label>
          {t("Points")}{" "}
          <select value={spectrum.points} onChange={(event) => change({ points: Number(event.currentTarget.value) })}>
            {[256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536].map((points) => (
              <option key={points} value={points}>
                {points}
              </option>
            ))}
          </select>
        </label>
        <label class="check">
          <input type="checkbox" checked={spectrum.decibels} onChange={(event) => change({ decibels: event.currentTarget.checked })} />
          dB
        </label>
        <label class="check">
          <input type="checkbox" checked={spectrum.removeMean} onChange={(event) => change({ removeMean: event.currentTarget.checked })} />
          {t("without mean")}
        </label>
        <span class="spacer" />
        <span class="soft">
          {first === undefined
            ? t("too few samples")
            : t("{value} points, {resolution} apart", {
                value: 2 * (first.spectrum.amplitude.length - 1),
                resolution: frequencyText(first.spectrum.resolution, 4),
              })}
        </span>
      </header>
      <canvas ref={canvas} role="img" aria-label={t("Amplitude over frequency; the highest lines are listed below")} />
      <ul class="peaks">
        {spectra.map(({ channel, peak, peakFrequency }) => (
          <li key={channel}>
            <span class="swatch" style={{ background: seriesColour(channel) }} />
            {t("{channel}: {peak} ({decibels} dB) at {frequency}", {
              channel: channels[channel]?.name ?? "",
              peak: `${numberText(peak, 5)} ${channels[channel] ? unitText(scope.display(channels[channel]).unit) : ""}`,
              decibels: numberText(decibels(peak), 4),
              frequency: frequencyText(peakFrequency, 5),
            })}
          </li>
        ))}
      </ul>
    </section>
  );
}
