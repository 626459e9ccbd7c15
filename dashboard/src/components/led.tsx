import { useEffect, useRef } from "preact/hooks";

import type { Led } from "../api";
import { changes, ledLit } from "../leds";

// One clock for all, so that equal patterns blink together, as on devices of one rack.
const kTick = 25;
type Blinker = (now: number) => void;
const blinkers = new Set<Blinker>();
let timer: ReturnType<typeof setInterval> | undefined;

function enlist(blinker: Blinker): () => void {
  blinkers.add(blinker);
  timer ??= setInterval(() => {
    const now = performance.now();
    for (const each of blinkers) {
      each(now);
    }
  }, kTick);
  return () => {
    blinkers.delete(blinker);
    if (blinkers.size === 0) {
      clearInterval(timer);
      timer = undefined;
    }
  };
}

function useBlinking(pattern: string) {
  const element = useRef<HTMLSpanElement & SVGCircleElement>(null);
  useEffect(() => {
    const show = (now: number) => {
      const lit = ledLit(pattern, now) ? "true" : "false";
      if (element.current && element.current.dataset["lit"] !== lit) {
        element.current.dataset["lit"] = lit;
      }
    };
    show(performance.now());
    return changes(pattern) ? enlist(show) : undefined;
  }, [pattern]);
  return element;
}

/// An indicator with its name.
export function LedLamp({ led }: { led: Led }) {
  const lamp = useBlinking(led.pattern);
  return (
    <span class="led" title={`${led.name}: ${led.colour}, ${led.pattern}`}>
      <span ref={lamp} class={`lamp ${led.colour}`} aria-hidden="true" />
      <span aria-hidden="true">{led.name}</span>
      <span class="hidden-text">{`${led.name} ${led.colour} ${led.pattern}`}</span>
    </span>
  );
}

/// The same inside a picture.
export function LedDot({ led, x, y }: { led: Led; x: number; y: number }) {
  const lamp = useBlinking(led.pattern);
  return (
    <g>
      <title>{`${led.name}: ${led.colour}, ${led.pattern}`}</title>
      <circle ref={lamp} class={`lamp ${led.colour}`} cx={x} cy={y} r={4.5} />
      <text class="small" x={x + 8} y={y + 3.5}>
        {led.name.replace(/^L\/A /, "")}
      </text>
    </g>
  );
}
