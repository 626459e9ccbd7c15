import { useMemo } from "preact/hooks";

import type { StateMachine } from "../api";
import { kBoxHeight, kBoxWidth, layOut, sameState } from "../machine_layout";

const kBad = /^(fault|faultreactionactive)$/;

/// A state machine with its current state lit and the ways out of it emphasised.
export function StateMachinePicture({ machine, state }: { machine: StateMachine; state: string }) {
  const layout = useMemo(() => layOut(machine), [machine]);
  const id = `arrow-${machine.name}`;
  return (
    <svg
      class="machine"
      viewBox={`0 0 ${layout.width} ${layout.height}`}
      width={layout.width}
      height={layout.height}
      role="img"
      aria-label={`${machine.title}: ${state}`}
    >
      <defs>
        {["", "-lit"].map((kind) => (
          <marker
            key={kind}
            id={id + kind}
            class={`head${kind}`}
            viewBox="0 0 8 8"
            refX="7.5"
            refY="4"
            markerWidth="7"
            markerHeight="7"
            orient="auto-start-reverse"
          >
            <path d="M0 0.8L8 4L0 7.2Z" />
          </marker>
        ))}
      </defs>
      {layout.arrows.map((arrow) => {
        const lit = arrow.from.some((each) => sameState(each, state));
        return (
          <g key={`${arrow.from.join()}>${arrow.to}`} class={lit ? "arrow lit" : "arrow"}>
            <title>{arrow.title}</title>
            <path d={arrow.path} marker-end={`url(#${id}${lit ? "-lit" : ""})`} />
            <text x={arrow.x} y={arrow.y + 3.5}>
              {arrow.label}
            </text>
          </g>
        );
      })}
      {layout.boxes.map((box) => {
        const lit = sameState(box.state, state);
        const bad = kBad.test(box.state.toLowerCase().replace(/[^a-z]/g, ""));
        return (
          <g key={box.state} class={`state${lit ? " lit" : ""}${bad ? " bad" : ""}`}>
            <rect x={box.x - kBoxWidth / 2} y={box.y - kBoxHeight / 2} width={kBoxWidth} height={kBoxHeight} rx="4" />
            <text x={box.x} y={box.y + 4}>
              {box.state.charAt(0).toUpperCase() + box.state.slice(1)}
            </text>
          </g>
        );
      })}
    </svg>
  );
}
