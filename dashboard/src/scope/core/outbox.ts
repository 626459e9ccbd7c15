// What waits for a page that is slow: bounded, the oldest samples give way.

interface Entry<T> {
  readonly message: T;
  readonly rows: number;
  readonly bytes: number;
}

/// Hands messages to `deliver`, `inFlight` of them at most before taken() is called. The rest waits
/// here; when that grows over `bytes`, the oldest with rows are dropped and their rows counted.
export class Outbox<T> {
  private readonly waiting: Entry<T>[] = [];
  private waitingBytes = 0;
  private underWay = 0;
  dropped = 0;

  constructor(
    private readonly deliver: (message: T) => void,
    private readonly inFlight: number,
    private readonly bytes: number,
  ) {}

  push(message: T, rows: number, bytes: number): void {
    this.waiting.push({ message, rows, bytes });
    this.waitingBytes += bytes;
    while (this.waitingBytes > this.bytes) {
      const victim = this.waiting.findIndex((entry) => entry.rows > 0);
      if (victim < 0) {
        break;
      }
      const [entry] = this.waiting.splice(victim, 1);
      this.waitingBytes -= entry!.bytes;
      this.dropped += entry!.rows;
    }
    this.send();
  }

  taken(messages: number): void {
    this.underWay = Math.max(0, this.underWay - messages);
    this.send();
  }

  private send(): void {
    while (this.underWay < this.inFlight && this.waiting.length > 0) {
      const entry = this.waiting.shift()!;
      this.waitingBytes -= entry.bytes;
      ++this.underWay;
      this.deliver(entry.message);
    }
  }
}
