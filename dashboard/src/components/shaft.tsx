import { useEffect, useRef } from "preact/hooks";

import { useWorld } from "../hooks";
import { shaftDegrees } from "../shafts";

/// A motor's shaft that turns as its signal says (revolutions).
export function ShaftDial({ signal, x, y, radius }: { signal: string; x: number; y: number; radius: number }) {
  const { hub } = useWorld();
  const shaft = useRef<SVGGElement>(null);
  useEffect(() => {
    const show = () => {
      const value = hub.value(signal)?.value;
      if (shaft.current && typeof value === "number") {
        shaft.current.setAttribute("transform", `rotate(${shaftDegrees(value).toFixed(1)} ${x} ${y})`);
      }
    };
    show();
    return hub.watch([signal], show);
  }, [hub, signal, x, y]);
  return (
    <g class="shaft">
      <circle class="stator" cx={x} cy={y} r={radius} />
      <g ref={shaft}>
        <circle class="rotor" cx={x} cy={y} r={radius * 0.62} />
        <path class="mark" d={`M${x} ${y - radius * 0.12}V${y - radius * 0.86}`} />
        <circle class="hub" cx={x} cy={y} r={radius * 0.14} />
      </g>
    </g>
  );
}
