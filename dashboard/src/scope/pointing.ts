// Mouse, wheel and keys on the picture.
import { t } from "../language";
import { type Oscilloscope } from "./oscilloscope";
import type { Picture, Scale } from "./picture";
import { zoomed } from "./core/view";

export type CursorName = "A" | "B" | "C" | "D";

type Drag =
  | { readonly kind: "cursor"; readonly cursor: CursorName }
  | { readonly kind: "pan"; x: number }
  | { readonly kind: "axis"; readonly scale: Scale; y: number }
  | { readonly kind: "box"; readonly x: number; readonly element: HTMLElement };

const kNear = 6; // pixels
const kWheel = 1.2; // per notch
const kFine = 0.002; // of the picture, per key
const kCoarse = 0.02;

/// Attaches itself to the canvas; returns what detaches it.
export class Pointing {
  /// The cursor that keys move.
  cursor: CursorName | null = null;
  private drag: Drag | null = null;
  private readonly abort = new AbortController();

  constructor(
    private readonly scope: Oscilloscope,
    private readonly picture: Picture,
    private readonly box: HTMLElement,
    private readonly announce: (text: string) => void,
  ) {
    const { canvas } = picture;
    const { signal } = this.abort;
    canvas.addEventListener("pointerdown", (event) => this.down(event), { signal });
    canvas.addEventListener("pointermove", (event) => this.move(event), { signal });
    canvas.addEventListener("pointerup", (event) => this.up(event), { signal });
    canvas.addEventListener("pointercancel", () => this.cancel(), { signal });
    canvas.addEventListener("dblclick", (event) => this.reset(event), { signal });
    canvas.addEventListener("wheel", (event) => this.wheel(event), { signal, passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event), { signal });
  }

  detach(): void {
    this.abort.abort();
  }

  private place(event: MouseEvent): { readonly x: number; readonly y: number } {
    const bounds = this.picture.canvas.getBoundingClientRect();
    return { x: event.clientX - bounds.left, y: event.clientY - bounds.top };
  }

  private cursorAt(x: number, y: number): CursorName | null {
    const { times, levels } = this.scope.cursors;
    if (times !== null && y < this.picture.plot.bottom) {
      for (const [name, time] of [
        ["A", times.a],
        ["B", times.b],
      ] as const) {
        if (Math.abs(this.picture.xOf(time) - x) <= kNear) {
          return name;
        }
      }
    }
    const scale = this.levelScale();
    if (levels !== null && scale !== null && x >= scale.box.left) {
      for (const [name, level] of [
        ["C", levels.a],
        ["D", levels.b],
      ] as const) {
        if (Math.abs(this.picture.yOf(scale, level) - y) <= kNear) {
          return name;
        }
      }
    }
    return null;
  }

  private levelScale(): Scale | null {
    return this.picture.scales.find(({ key }) => key === this.scope.cursors.levels?.key) ?? null;
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) {
      return;
    }
    const { x, y } = this.place(event);
    this.picture.canvas.setPointerCapture(event.pointerId);
    const cursor = this.cursorAt(x, y);
    const scale = this.picture.scaleAt(x, y);
    if (cursor !== null) {
      this.cursor = cursor;
      this.drag = { kind: "cursor", cursor };
    } else if (scale !== null && x < scale.gutter.right) {
      this.drag = { kind: "axis", scale, y };
    } else if (event.shiftKey) {
      this.drag = { kind: "box", x, element: this.box };
    } else {
      this.drag = { kind: "pan", x };
    }
  }

  private move(event: PointerEvent): void {
    const { x, y } = this.place(event);
    const { drag, picture } = this;
    if (drag === null) {
      const cursor = this.cursorAt(x, y);
      picture.canvas.style.cursor =
        cursor === null ? (x < picture.plot.left ? "ns-resize" : "grab") : cursor < "C" ? "ew-resize" : "ns-resize";
      return;
    }
    switch (drag.kind) {
      case "cursor":
        this.moveCursorTo(drag.cursor, x, y);
        break;
      case "pan": {
        const kStill = 2;
        if (Math.abs(x - drag.x) >= kStill || this.scope.held !== null) {
          this.scope.pan((drag.x - x) / (picture.plot.right - picture.plot.left));
          drag.x = x;
        }
        break;
      }
      case "axis": {
        const scale = picture.scales.find(({ key }) => key === drag.scale.key);
        if (scale !== undefined) {
          const by = picture.levelAt(scale, drag.y) - picture.levelAt(scale, y);
          this.scope.changeAxis(scale.key, { from: scale.range.from + by, to: scale.range.to + by });
          drag.y = y;
        }
        break;
      }
      case "box":
        drag.element.hidden = false;
        drag.element.style.left = `${Math.min(x, drag.x)}px`;
        drag.element.style.width = `${Math.abs(x - drag.x)}px`;
        break;
    }
  }

  private up(event: PointerEvent): void {
    const { drag } = this;
    this.cancel();
    if (drag?.kind === "box") {
      const { x } = this.place(event);
      const kLeast = 4;
      if (Math.abs(x - drag.x) >= kLeast) {
        this.scope.hold({ from: this.picture.timeAt(Math.min(x, drag.x)), to: this.picture.timeAt(Math.max(x, drag.x)) });
      }
    }
  }

  private cancel(): void {
    this.drag = null;
    this.box.hidden = true;
  }

  private reset(event: MouseEvent): void {
    const { x, y } = this.place(event);
    const scale = this.picture.scaleAt(x, y);
    if (scale !== null && x < scale.gutter.right) {
      this.scope.changeAxis(scale.key, null);
    } else {
      this.scope.follow();
    }
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const { x, y } = this.place(event);
    const { picture } = this;
    const factor = kWheel ** Math.sign(event.deltaY || event.deltaX);
    const scale = picture.scaleAt(x, y);
    if (scale !== null && (x < scale.gutter.right || event.ctrlKey)) {
      this.scope.changeAxis(scale.key, zoomed(scale.range, factor, picture.levelAt(scale, y), 1e-12, 1e15));
    } else if (event.shiftKey || event.deltaX !== 0) {
      const kStep = 0.1;
      this.scope.pan(kStep * Math.sign(event.deltaX || event.deltaY));
    } else {
      this.scope.zoom(factor, picture.timeAt(Math.max(x, picture.plot.left)));
    }
  }

  private moveCursorTo(cursor: CursorName, x: number, y: number): void {
    const { times, levels } = this.scope.cursors;
    const { plot } = this.picture;
    const scale = this.levelScale();
    if (cursor < "C" && times !== null) {
      const time = this.picture.timeAt(Math.min(plot.right, Math.max(plot.left, x)));
      this.scope.setCursors({ times: cursor === "A" ? { ...times, a: time } : { ...times, b: time } });
    } else if (levels !== null && scale !== null) {
      const level = this.picture.levelAt(scale, Math.min(scale.box.bottom, Math.max(scale.box.top, y)));
      this.scope.setCursors({ levels: cursor === "C" ? { ...levels, a: level } : { ...levels, b: level } });
    }
  }

  private moveCursorBy(share: number, vertical: boolean): void {
    const { times, levels } = this.scope.cursors;
    const scale = this.levelScale();
    if (this.cursor === null || this.cursor >= "C" !== vertical) {
      return;
    }
    const x = this.cursor === "A" ? times?.a : times?.b;
    const y = this.cursor === "C" ? levels?.a : levels?.b;
    const { plot } = this.picture;
    if (!vertical && x !== undefined) {
      this.moveCursorTo(this.cursor, this.picture.xOf(x) + share * (plot.right - plot.left), 0);
    } else if (vertical && y !== undefined && scale !== null) {
      this.moveCursorTo(this.cursor, 0, this.picture.yOf(scale, y) - share * (scale.box.bottom - scale.box.top));
    }
  }

  private choose(cursor: CursorName): void {
    const { times, levels } = this.scope.cursors;
    const there = cursor < "C" ? times !== null : levels !== null;
    this.cursor = there ? cursor : null;
    this.announce(there ? t("Cursor {cursor}; the arrows move it", { cursor }) : t("Cursor {cursor} is not shown", { cursor }));
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    const { scope, picture } = this;
    const step = event.shiftKey ? kFine : kCoarse;
    const middle = (picture.shown.from + picture.shown.to) / 2;
    const kPan = event.shiftKey ? 0.02 : 0.1;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => (this.cursor !== null && this.cursor < "C" ? this.moveCursorBy(-step, false) : scope.pan(-kPan)),
      ArrowRight: () => (this.cursor !== null && this.cursor < "C" ? this.moveCursorBy(step, false) : scope.pan(kPan)),
      ArrowUp: () => this.moveCursorBy(step, true),
      ArrowDown: () => this.moveCursorBy(-step, true),
      PageUp: () => scope.pan(-1),
      PageDown: () => scope.pan(1),
      "+": () => scope.zoom(1 / kWheel, middle),
      "=": () => scope.zoom(1 / kWheel, middle),
      "-": () => scope.zoom(kWheel, middle),
      Home: () => scope.follow(),
      " ": () => (scope.running ? scope.stop() : scope.run()),
      s: () => scope.single(),
      t: () => scope.force(),
      "<": () => scope.stepSpan(-1),
      ">": () => scope.stepSpan(1),
      a: () => this.choose("A"),
      b: () => this.choose("B"),
      c: () => this.choose("C"),
      d: () => this.choose("D"),
      Escape: () => {
        this.cursor = null;
        this.announce(t("No cursor chosen"));
      },
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action !== undefined) {
      event.preventDefault();
      action();
    }
  }
}
