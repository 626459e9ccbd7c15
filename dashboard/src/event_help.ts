// What kinds of events mean and what to do about them, for people who meet one. An event's own sentence tells what came
// and what was expected; this tells which rule of the field stands behind it.

export interface EventHelp {
  readonly means: string;
  readonly remedy: string;
  /// Document below docs/.
  readonly guide: string;
}

/// By the name of a kind of event, or by the beginning of several, which ends in "-". The longest that fits counts.
const kHelp: readonly (readonly [start: string, means: string, remedy: string, guide: string])[] = [
  [
    "al-",
    "The EtherCAT state machine of the slave did not take a request of the master.",
    "Mend what the sentence names, acknowledge with bit 4 of AL control, then request the state again.",
    "how-to/refused-states.md",
  ],
  ["al-state-changed", "The slave has taken the state that the master requested.", "Nothing is to be done.", "how-to/refused-states.md"],
  [
    "al-error-raised",
    "The slave shows an error in AL status, and takes no higher state until the master acknowledges it.",
    "Read the code in 0134h, mend its cause, acknowledge with bit 4 of AL control.",
    "how-to/refused-states.md",
  ],
  [
    "al-watchdog",
    "No outputs came for longer than the process-data watchdog allows, so the slave left Operational to be safe.",
    "Send process data in time, or set a longer watchdog (0400h, 0420h); then acknowledge and request Operational again.",
    "how-to/refused-states.md",
  ],
  [
    "al-stepped-down",
    "The slave left a state on its own because what that state needs is gone.",
    "Restore it, acknowledge, and request the state again.",
    "how-to/refused-states.md",
  ],
  ["al-fault", "A fault that was asked for refuses this state.", "Clear the fault in the view of faults.", "how-to/faults.md"],
  [
    "al-controller-lost",
    "The slave controller has lost its EEPROM's content or its interface to the firmware, so nobody answers the master.",
    "Repair the EEPROM, then switch the device off and on.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "al-controller-back",
    "The firmware reaches its slave controller again.",
    "Request the state again.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "dc-",
    "What the slave needs to run with SYNC0, the pulse of its distributed clock, is not given.",
    "Set cycle, start time and activation before Safe-Operational, and distribute the reference time in each cycle.",
    "how-to/refused-states.md",
  ],
  [
    "esc-",
    "A register of the slave controller was accessed in a way that it does not take, or its hardware is set up otherwise.",
    "Compare the access with the table of registers.",
    "how-to/registers.md",
  ],
  [
    "esc-sii-",
    "The EEPROM interface of the slave controller (SII) did not execute a command, or found its content wrong.",
    "Acknowledge the error in 0502h; a damaged content is written anew or replaced by a file.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "mailbox-",
    "A mailbox message of the master was not understood, or came twice.",
    "Check its header: length, protocol, and a counter that grows with each message.",
    "how-to/refused-states.md",
  ],
  [
    "pdo-",
    "A PDO mapping, or what came in a PDO, does not fit the objects.",
    "Change mappings in Pre-Operational: count to 0, then the entries, then the count.",
    "how-to/refused-states.md",
  ],
  [
    "od-",
    "An object of the dictionary was accessed in a way that its declaration forbids: type, range, rights or state.",
    "Look the object up in the dictionary: its range, its access and when it may be written stand there.",
    "how-to/dashboard.md",
  ],
  [
    "sdo-",
    "An SDO transfer was refused or ended before it was complete.",
    "The abort code names the rule; check index, subindex, length and the client's time limit.",
    "how-to/can-links.md",
  ],
  ["sdo-value-changed", "A value changed its length while a master read it in pieces.", "Read it again.", "how-to/can-links.md"],
  ["object-set", "A value of the dictionary was changed from outside, not by the master.", "Nothing is to be done.", "how-to/dashboard.md"],
  [
    "pds-",
    "The power state machine of CiA 402 does not take this controlword in its present state.",
    "Go step by step, 6, 7, 15, and wait for the statusword after each; in Fault set bit 7 first.",
    "how-to/dashboard.md",
  ],
  [
    "axis-",
    "The drive's supervision of an axis found something that endangers motor, driver or mechanics.",
    "Remove the cause, then reset the fault with a rising edge of bit 7 in the controlword.",
    "how-to/plant-faults.md",
  ],
  [
    "axis-following-error",
    "The shaft is further from where it should be than 6065h allows for the time in 6066h.",
    "Look for a blocked shaft, too little current or too fast a profile; reset the fault, or allow a wider window.",
    "how-to/plant-faults.md",
  ],
  [
    "axis-stall",
    "The load measurement says that the motor is about to lose steps, and the stop on stall was switched on.",
    "Lower load or acceleration, raise the current, or set another threshold; then move again.",
    "how-to/stallguard-and-coolstep.md",
  ],
  [
    "axis-open-load-",
    "The driver chip sees no current in a phase: a wire or a winding is open.",
    "Look at the inputs of the motor's wires; at rest and at high speed the detection may be wrong.",
    "how-to/driver-faults.md",
  ],
  [
    "axis-overcurrent-",
    "The driver chip saw more current than it stands and switched itself off.",
    "Remove the short circuit, then reset the fault.",
    "how-to/driver-faults.md",
  ],
  [
    "axis-over-temperature",
    "The driver is too hot, or nearly so.",
    "Lower the current or cool the module; after it was switched off, reset the fault.",
    "how-to/driver-faults.md",
  ],
  [
    "axis-driver-error",
    "The driver chip reported a fault of its own.",
    "Remove its cause, then reset the fault.",
    "how-to/driver-faults.md",
  ],
  [
    "axis-positive-",
    "The axis has reached an end of its way in the positive direction: a switch, or a limit in 607Dh.",
    "Move back; motion in that direction only is held back.",
    "how-to/homing.md",
  ],
  [
    "axis-negative-",
    "The axis has reached an end of its way in the negative direction: a switch, or a limit in 607Dh.",
    "Move back; motion in that direction only is held back.",
    "how-to/homing.md",
  ],
  [
    "homing-",
    "The reference search could not begin, or did not find what it searches for.",
    "Check method, speeds and switches; the search ends with bit 13 of the statusword.",
    "how-to/homing.md",
  ],
  [
    "closed-loop-",
    "Closed loop needs an encoder whose resolution is known, and gains.",
    "Set the objects that the sentence names before the loop is closed.",
    "how-to/closed-loop.md",
  ],
  [
    "torque-needs-closed-loop",
    "A stepper gives a commanded torque in closed loop only.",
    "Close the loop, then choose the torque mode.",
    "how-to/closed-loop.md",
  ],
  [
    "emergency",
    "The device tells its master of an error by an emergency message (CiA 301): error code, error register, details.",
    "Remove the cause of the code; the device sends code 0000h when the last error is gone.",
    "how-to/plant-faults.md",
  ],
  ["emergency-cleared", "An error of which the device had told its master is gone.", "Nothing is to be done.", "how-to/plant-faults.md"],
  [
    "error-",
    "The error history (1003h) or the behaviour at errors (1029h) was accessed with what it does not take.",
    "1003h:00 takes 0 only, which empties it; 1029h takes the values of CiA 301.",
    "how-to/can-links.md",
  ],
  [
    "error-reaction",
    "An error has made the node leave Operational, as 1029h asks.",
    "The emergency message before it tells the cause; start the node again when it is gone.",
    "how-to/can-links.md",
  ],
  [
    "cable-",
    "A cable of the segment was broken or healed, by an event or a fault.",
    "Slaves behind a broken cable are reached again when it heals, in a ring from the other side.",
    "how-to/cable-redundancy.md",
  ],
  [
    "carrier-",
    "The interface at the rack's end of the link lost its carrier or has it again: what is at its other end is off, or on.",
    "Switch the other end on: ip link set INTERFACE up, or plug the cable.",
    "how-to/links.md",
  ],
  ["power-", "A device was switched off or on.", "A device that starts anew has forgotten what was not stored.", "rack-file.md"],
  [
    "input-",
    "Something around a device was set: a load, a switch, a supply. Where a fault holds it, it takes effect when the fault ends.",
    "Nothing is to be done.",
    "how-to/plant-faults.md",
  ],
  ["fault-", "A fault that was asked for begins or ends.", "All that are armed or active stand in the view of faults.", "how-to/faults.md"],
  ["ethercat-frame-fault", "A fault that was asked for damages or loses frames.", "Clear it in the view of faults.", "how-to/faults.md"],
  ["can-frame-fault", "A fault that was asked for damages or loses frames.", "Clear it in the view of faults.", "how-to/faults.md"],
  [
    "can-",
    "The state of a CAN controller has changed: its error counters decide whether it may send and how (CAN 2.0, fault confinement).",
    "Look for frames that nobody acknowledges or that are damaged, and for another bit rate.",
    "how-to/can-links.md",
  ],
  ["can-connected", "The device's CAN cable is plugged again.", "Nothing is to be done.", "how-to/can-links.md"],
  ["can-disconnected", "The device's CAN cable is unplugged.", "Plug it, or clear the fault that has unplugged it.", "how-to/can-links.md"],
  [
    "can-bit-rate-differs",
    "A program at a port asked for another bit rate than the bus has. Its frames pass all the same.",
    "On real hardware they would not: give the program the bus's bit rate.",
    "how-to/can-links.md",
  ],
  [
    "nmt-",
    "The NMT master changed the state of a node, or sent a command that it does not take.",
    "A command has two bytes: the command and the node-ID, or 0 for all.",
    "how-to/can-links.md",
  ],
  ["nmt-state", "The NMT state of a node has changed.", "Nothing is to be done.", "how-to/can-links.md"],
  [
    "cob-id-",
    "A COB-ID was written that the node cannot use: reserved, taken by another object, or changed while valid.",
    "Switch the object off by bit 31 first, then write the new identifier.",
    "how-to/can-links.md",
  ],
  [
    "heartbeat-",
    "The node watches heartbeats of others (1016h) and misses one, has it back, or cannot watch it as written.",
    "Have the producer send in time, or write a longer time to 1016h.",
    "how-to/can-links.md",
  ],
  [
    "life-guarding-",
    "The master's node guarding stayed away longer than life time (100Ch, 100Dh), or is back.",
    "Send guarding requests in time, or set the life time to 0.",
    "how-to/can-links.md",
  ],
  [
    "guarding-with-heartbeat",
    "A node that sends a heartbeat does not answer node guarding (CiA 301).",
    "Write 0 to 1017h, or wait for the heartbeat instead.",
    "how-to/can-links.md",
  ],
  [
    "lss-",
    "A command of the Layer Setting Services (CiA 305) does not fit the state or the values of the node.",
    "Switch the node to configuration state, set node-ID or bit timing, then store them.",
    "how-to/can-links.md",
  ],
  [
    "sync-",
    "The counter of SYNC (1019h) was written when or with what it does not take.",
    "Write 0 to 1006h first, then 0 or 2 to 240.",
    "how-to/can-links.md",
  ],
  ["time-", "A TIME message was not six bytes long.", "Send time of day and days as CiA 301 defines them.", "how-to/can-links.md"],
  [
    "eoe-",
    "Ethernet over EtherCAT: an address was set, or a frame or a setting was refused.",
    "Check address and mask, and that the TAP interface of the device exists.",
    "how-to/links.md",
  ],
  [
    "foe-",
    "A file transfer over EtherCAT came through, was refused, or was given up.",
    "Check state, name and password of the file; firmware is taken in Bootstrap.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "new-firmware",
    "A firmware image was loaded and kept. The virtual device does not run it and behaves as before.",
    "Nothing is to be done.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "storage-",
    "The device restored something from its kept memory, or could not store it.",
    'Parameters are stored by writing "save" to 1010h; the state directory of the rack must be writable.',
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "stored-parameters-",
    "Stored parameters are damaged or another product's, so the device starts with its defaults.",
    "Store them again.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "output-",
    "A file or a pipe that the rack writes takes less than comes, or takes nothing any more.",
    "Free the disk or read faster; what was lost is counted.",
    "how-to/slow-readers.md",
  ],
  [
    "manual-control-",
    "The small master inside Stator took a device, gave it back, or lost it to another master.",
    "Take control again when the other master is done.",
    "how-to/move-by-hand.md",
  ],
  [
    "generic-",
    "A device that was made of a file refused a mode of operation that its 6502h does not list.",
    "Choose a mode of 6502h; if the device has the mode nevertheless, change 6502h in the file.",
    "how-to/any-device.md",
  ],
  [
    "tmcl-",
    "A command of TMCL was refused, or did not arrive whole.",
    "Check command, type, motor and value against the module's manual, and the telegram's checksum.",
    "how-to/serial-lines.md",
  ],
  [
    "tmcl-boot-loader",
    "The module's boot loader runs and waits for a firmware.",
    "Load one, or start the firmware there is.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "tmcl-program-",
    "The TMCL program of a module did something that the module does not take, or ran past its end.",
    "Run it in the debugger: stator tmcl debug.",
    "how-to/tmcl-programs.md",
  ],
  [
    "tmcm142-",
    "The module's own supervision acted, or a parameter was set to what it cannot do.",
    "Read the parameter that the sentence names, remove the cause, then move again.",
    "devices/tmcm-142.md",
  ],
  [
    "tmcm3315-",
    "An object of this product was written with a value that it does not take.",
    "Its device page tells what is possible.",
    "devices/tmcm-3315.md",
  ],
  [
    "tmcm-3315-new-firmware",
    "A firmware image was loaded and kept. The virtual device does not run it and behaves as before.",
    "Nothing is to be done.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  ["tmcc160-", "A setting of this product does not fit another one.", "Its device page tells what goes together.", "devices/tmcc160.md"],
  [
    "tmcc160-new-firmware",
    "A firmware image was loaded and kept. The virtual device does not run it and behaves as before.",
    "Nothing is to be done.",
    "how-to/firmware-and-eeprom-files.md",
  ],
  [
    "tmc8670-",
    "A limit of this chip was met: supply, temperature, or a setting that does not fit.",
    "Its device page tells the limits.",
    "devices/tmc8670.md",
  ],
  [
    "tmc8670-new-firmware",
    "A firmware image was loaded and kept. The virtual device does not run it and behaves as before.",
    "Nothing is to be done.",
    "how-to/firmware-and-eeprom-files.md",
  ],
];

/// Null: of a kind that this page does not know.
export function explainRule(rule: string): EventHelp | null {
  let best: (typeof kHelp)[number] | null = null;
  for (const row of kHelp) {
    const [start] = row;
    if ((start === rule || (start.endsWith("-") && rule.startsWith(start))) && start.length > (best?.[0].length ?? 0)) {
      best = row;
    }
  }
  return best === null ? null : { means: best[1], remedy: best[2], guide: best[3] };
}

/// All documents that are named.
export function guides(): string[] {
  return [...new Set(kHelp.map(([, , , guide]) => guide))];
}

export interface ObjectAddress {
  readonly index: string;
  readonly subindex: string | null;
}

/// Numbers of four digits that are no objects: codes and values.
const kNoObject = /(AL status|error|code|controlword|AL control|CRC is|CAN-ID|with) $/;
/// The sentences of these tell objects of the first axis, whichever axis they are about.
const kOfFirstAxis = /^(axis|homing|closed-loop|pds)-/;
const kAxisOffset = 0x800;

/// The objects a sentence names, each once; some may be registers, which the dictionary does not have.
export function namedObjects(rule: string, text: string): ObjectAddress[] {
  const axis = kOfFirstAxis.test(rule) ? Number(/\baxis (\d+)/.exec(text)?.[1] ?? 0) : 0;
  const found = new Map<string, ObjectAddress>();
  for (const match of text.matchAll(/\b([0-9A-F]{4})h(?::([0-9A-F]{2})h?)?/g)) {
    const number = Number.parseInt(match[1] ?? "", 16);
    if (number < 0x1000 || kNoObject.test(text.slice(0, match.index))) {
      continue;
    }
    const moved = number >= 0x6000 && number < 0x6800 ? number + axis * kAxisOffset : number;
    const address = { index: moved.toString(16).toUpperCase(), subindex: match[2] ?? null };
    found.set(`${address.index}:${address.subindex ?? ""}`, address);
  }
  return [...found.values()];
}

/// The error code that an event about an emergency tells; null: it is about none.
export function emergencyCode(rule: string, text: string): number | null {
  const found = /^emergency/.test(rule) ? /\berror ([0-9A-F]{4})h/.exec(text) : null;
  return found ? Number.parseInt(found[1] ?? "", 16) : null;
}
