// Whether the master of a network still speaks, judged by its own rhythm: a cycle of a millisecond and a look every ten
// seconds are both a master that is there.

/// A pause is silence when it is this many times as long as the master's usual one ...
const kPauses = 5;
/// ... and longer than the network's counter may take to be looked at, in milliseconds.
const kShortest = 3000;
/// How much a new pause counts against the ones before.
const kWeight = 0.3;

/// What is known of the master of one network.
export class MasterActivity {
  private received: number | null = null;
  /// Until when nothing is known to have come; null: it has not been seen to speak.
  private spoke: number | null = null;
  private since = 0;
  private pause: number | null = null;

  /// `received` is what the network has counted from masters at `now`, in milliseconds.
  look(received: number, now: number): void {
    if (this.received === null || received < this.received) {
      this.spoke = null; // looked at for the first time, or another run
      this.pause = null;
      this.since = now;
    } else if (received > this.received) {
      // A pause is known from the second look on at which something has come.
      if (this.spoke !== null) {
        const mean = (now - this.spoke) / (received - this.received);
        this.pause = this.pause === null ? mean : this.pause + kWeight * (mean - this.pause);
      }
      this.spoke = now;
    }
    this.received = received;
  }

  /// For how long it has been silent, in milliseconds; null: it speaks, or nobody can tell yet.
  silence(now: number): number | null {
    const silent = now - (this.spoke ?? this.since);
    if (this.received === null || silent < Math.max(kShortest, kPauses * (this.pause ?? 0))) {
      return null;
    }
    return silent;
  }

  /// Since the page looks at it.
  get hasSpoken(): boolean {
    return this.spoke !== null;
  }
}
