// Turns an axis as long as a button is held.
import type { ManualCommand } from "./api";

/// An axis goes on for 0.4 s after a command to jog, so one that comes late now and then does no harm.
const kRepeat = 150; ///< ms

/// Repeats the command to jog until it is released, then sends the one to stop. No command is sent before the one
/// before it was answered: requests take connections of their own, and a jog that overtook the stop would turn the
/// axis once more. A jog that does not come through ends it; the device then stops by itself.
export class Jog {
  private velocity: number | null = null;
  private running = false;
  private wake: () => void = () => undefined;

  /// `send` gives whether the command came through.
  constructor(private readonly send: (command: ManualCommand) => Promise<boolean>) {}

  /// Turns at `velocity`, in the units of the device, from now on.
  hold(velocity: number): void {
    this.velocity = velocity;
    if (!this.running) {
      this.running = true;
      void this.run();
    }
  }

  release(): void {
    this.velocity = null;
    this.wake();
  }

  private wanted(): number | null {
    return this.velocity;
  }

  private async run(): Promise<void> {
    for (let velocity = this.wanted(); velocity !== null; velocity = this.wanted()) {
      if (!(await this.send({ command: "jog", value: velocity }))) {
        this.velocity = null;
        break;
      }
      await this.pause();
      if (this.wanted() === null) {
        await this.send({ command: "stop" });
      }
    }
    this.running = false;
  }

  private pause(): Promise<void> {
    return new Promise((done) => {
      if (this.velocity === null) {
        done();
        return;
      }
      const timer = setTimeout(done, kRepeat);
      this.wake = () => {
        clearTimeout(timer);
        done();
      };
    });
  }
}
