// A machine in three dimensions that moves as shafts do: a gantry of three axes, or a rotary table. Loaded on demand.
import {
  AmbientLight,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CylinderGeometry,
  DirectionalLight,
  GridHelper,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { spanOf } from "./span";

/// As CSS writes colours: of what stands still, and of each axis.
export interface Colours {
  readonly frame: string;
  readonly axes: readonly string[];
}

const kEase = 0.06; ///< s in which the machine follows what it is told 25 times a second
const kTrail = 3000; ///< points of the way that is drawn
const kTravel = 0.42; ///< of the length of an axis to either side
const kWidth = 4;
const kDepth = 3;
const kStroke = 0.9;
const kTurnStep = 0.1; ///< rad per key press

/// What moves; told positions in revolutions.
interface Moving {
  place(revolutions: readonly number[]): void;
}

function box(x: number, y: number, z: number, colour: string): Mesh {
  return new Mesh(new BoxGeometry(x, y, z), new MeshLambertMaterial({ color: colour }));
}

/// x along the frame, y across it, z up and down; the way of the tool is drawn on the table.
class Gantry implements Moving {
  private readonly bridge = new Group();
  private readonly carriage = new Group();
  private readonly quill = new Group();
  private readonly points = new Float32Array(kTrail * 3);
  private readonly trail = new BufferGeometry();
  private count = 0;
  private readonly most = [0, 0, 0];
  private spans = [1, 1, 1];

  constructor(scene: Scene, colours: Colours) {
    const [x = "", y = "", z = ""] = colours.axes;
    for (const side of [-1, 1]) {
      const rail = box(kWidth, 0.12, 0.12, colours.frame);
      rail.position.set(0, 1.2, (side * kDepth) / 2);
      scene.add(rail);
      const post = box(0.14, 1.3, 0.14, x);
      post.position.set(0, 1.75, (side * kDepth) / 2);
      this.bridge.add(post);
      for (const end of [-1, 1]) {
        const leg = box(0.12, 1.2, 0.12, colours.frame);
        leg.position.set((end * kWidth) / 2, 0.6, (side * kDepth) / 2);
        scene.add(leg);
      }
    }
    const beam = box(0.2, 0.2, kDepth, x);
    beam.position.y = 2.4;
    this.bridge.add(beam, this.carriage);
    const block = box(0.42, 0.42, 0.42, y);
    block.position.y = 2.4;
    this.carriage.add(block, this.quill);
    const spindle = box(0.16, 1.5, 0.16, z);
    spindle.position.y = 1.95;
    const tip = new Mesh(new CylinderGeometry(0.08, 0.01, 0.24, 16), new MeshLambertMaterial({ color: z }));
    tip.position.y = 1.08;
    this.quill.add(spindle, tip);
    scene.add(this.bridge);
    this.trail.setAttribute("position", new BufferAttribute(this.points, 3));
    const line = new Line(this.trail, new LineBasicMaterial({ color: y }));
    line.frustumCulled = false;
    scene.add(line);
  }

  place(revolutions: readonly number[]): void {
    const spans = this.spans.map((span, i) => {
      this.most[i] = Math.max(this.most[i] ?? 0, Math.abs(revolutions[i] ?? 0));
      return Math.max(span, spanOf(this.most[i] ?? 0));
    });
    if (spans.some((span, i) => span !== this.spans[i])) {
      this.spans = spans;
      this.count = 0; // it was drawn to another scale
    }
    const part = (axis: number) => (revolutions[axis] ?? 0) / (spans[axis] ?? 1);
    this.bridge.position.x = part(0) * kTravel * kWidth;
    this.carriage.position.z = -part(1) * kTravel * kDepth;
    this.quill.position.y = -0.45 + part(2) * kStroke * 0.5;
    this.draw(this.bridge.position.x, this.carriage.position.z);
  }

  private draw(x: number, z: number): void {
    const last = (this.count - 1) * 3;
    if (this.count > 0 && Math.hypot(x - (this.points[last] ?? 0), z - (this.points[last + 2] ?? 0)) < 0.005) {
      return;
    }
    if (this.count === kTrail) {
      this.points.copyWithin(0, (kTrail / 2) * 3);
      this.count = kTrail / 2;
    }
    this.points.set([x, 0.02, z], this.count * 3);
    ++this.count;
    this.trail.setDrawRange(0, this.count);
    const position = this.trail.getAttribute("position");
    position.needsUpdate = true;
  }
}

class RotaryTable implements Moving {
  private readonly table = new Group();

  constructor(scene: Scene, colours: Colours) {
    const [own = ""] = colours.axes;
    const foot = new Mesh(new CylinderGeometry(1.5, 1.7, 0.5, 48), new MeshLambertMaterial({ color: colours.frame }));
    foot.position.y = 0.25;
    const disc = new Mesh(new CylinderGeometry(1.35, 1.35, 0.24, 48), new MeshLambertMaterial({ color: own }));
    disc.position.y = 0.63;
    this.table.add(disc);
    for (let i = 0; i < 12; ++i) {
      const mark = box(i === 0 ? 0.9 : 0.24, 0.05, i === 0 ? 0.12 : 0.05, colours.frame);
      const angle = (i * Math.PI) / 6;
      const radius = i === 0 ? 0.8 : 1.15;
      mark.position.set(radius * Math.cos(angle), 0.77, -radius * Math.sin(angle));
      mark.rotation.y = angle;
      this.table.add(mark);
    }
    const work = box(0.4, 0.5, 0.4, colours.frame);
    work.position.y = 0.98;
    this.table.add(work);
    const pointer = box(0.35, 0.08, 0.08, own);
    pointer.position.set(1.85, 0.72, 0);
    scene.add(foot, this.table, pointer);
  }

  place(revolutions: readonly number[]): void {
    this.table.rotation.y = (revolutions[0] ?? 0) * 2 * Math.PI;
  }
}

/// Throws where there is no WebGL.
export class Machine {
  readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(38, 1.6, 0.1, 60);
  private readonly controls: OrbitControls;
  private readonly moving: Moving;
  private readonly centre = new Vector3(0, 0.9, 0);
  private readonly shown: number[];
  private target: readonly number[];
  private request = 0;
  private last = 0;
  private fresh = true;

  constructor(canvas: HTMLCanvasElement, axes: number, colours: Colours) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(3, 6, 4);
    this.scene.add(sun, new GridHelper(6, 12, colours.frame, colours.frame));
    this.moving = axes >= 3 ? new Gantry(this.scene, colours) : new RotaryTable(this.scene, colours);
    this.shown = Array<number>(axes).fill(0);
    this.target = [...this.shown];
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.enableZoom = false; // until it has the focus, so that a wheel scrolls the page past it
    this.controls.minDistance = 3;
    this.controls.maxDistance = 20;
    this.controls.maxPolarAngle = Math.PI / 2;
    this.controls.addEventListener("change", () => this.wake());
    canvas.addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("focus", () => (this.controls.enableZoom = true));
    canvas.addEventListener("blur", () => (this.controls.enableZoom = false));
    this.home();
  }

  /// In revolutions, one for each axis.
  set(revolutions: readonly number[]): void {
    this.target = revolutions;
    if (this.fresh) {
      this.fresh = false;
      this.shown.splice(0, this.shown.length, ...revolutions);
    }
    this.wake();
  }

  resize(width: number, height: number): void {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.wake();
  }

  dispose(): void {
    cancelAnimationFrame(this.request);
    this.controls.dispose();
    this.scene.traverse((part) => {
      if (part instanceof Mesh || part instanceof Line) {
        (part.geometry as BufferGeometry).dispose();
        (part.material as MeshLambertMaterial).dispose();
      }
    });
    this.renderer.dispose();
  }

  private home(): void {
    this.camera.position.set(4.8, 4.6, 6.6);
    this.controls.target.copy(this.centre);
    this.controls.update();
    this.wake();
  }

  private wake(): void {
    if (this.request === 0) {
      this.request = requestAnimationFrame((now) => this.frame(now));
    }
  }

  private frame(now: number): void {
    this.request = 0;
    const seconds = Math.min(0.1, Math.max(0.001, (now - this.last) / 1000));
    this.last = now;
    const part = 1 - Math.exp(-seconds / kEase);
    let moves = false;
    for (let i = 0; i < this.shown.length; ++i) {
      const rest = (this.target[i] ?? 0) - (this.shown[i] ?? 0);
      moves ||= Math.abs(rest) > 1e-4;
      this.shown[i] = (this.shown[i] ?? 0) + (Math.abs(rest) > 1e-4 ? rest * part : rest);
    }
    this.moving.place(this.shown);
    this.renderer.render(this.scene, this.camera);
    if (moves) {
      this.wake();
    }
  }

  /// Arrows turn the view, plus and minus bring it closer, home puts it where it began.
  private key(event: KeyboardEvent): void {
    const turns: Readonly<Record<string, readonly [number, number, number]>> = {
      ArrowLeft: [-kTurnStep, 0, 1],
      ArrowRight: [kTurnStep, 0, 1],
      ArrowUp: [0, -kTurnStep, 1],
      ArrowDown: [0, kTurnStep, 1],
      "+": [0, 0, 0.9],
      "-": [0, 0, 1 / 0.9],
    };
    const turn = turns[event.key];
    if (event.key === "Home") {
      this.home();
    } else if (turn) {
      const place = new Spherical().setFromVector3(this.camera.position.clone().sub(this.centre));
      place.theta += turn[0];
      place.phi = Math.min(this.controls.maxPolarAngle, Math.max(0.05, place.phi + turn[1]));
      place.radius = Math.min(this.controls.maxDistance, Math.max(this.controls.minDistance, place.radius * turn[2]));
      this.camera.position.setFromSpherical(place).add(this.centre);
      this.controls.update();
      this.wake();
    } else {
      return;
    }
    event.preventDefault();
  }
}
