// Answers of the server, as docs/openapi.json declares them. Members that a server may leave out are
// optional here.

export interface Problem {
  readonly type?: string;
  readonly title?: string;
  readonly status?: number;
  readonly detail?: string;
  readonly abort_code?: string;
  readonly abort_text?: string;
}

export interface NetworkInfo {
  readonly name: string;
  readonly kind: string;
  readonly received: number;
  readonly overruns: number;
  readonly worst_lag_ns: number;
}

export interface RackInfo {
  readonly run: string; ///< another: the rack was started again, or went back to a snapshot
  readonly clock: string;
  readonly time_ns: number;
  readonly lost_ns: number; ///< the machine was too slow for
  readonly networks: readonly NetworkInfo[];
  readonly devices: number;
  readonly signals: number;
}

export interface DeviceInfo {
  readonly name: string;
  readonly product: string;
  readonly network: string;
  readonly powered: boolean;
  readonly state: string;
  readonly objects: number;
  readonly inputs: number;
}

export interface SignalValue {
  readonly name: string;
  readonly unit: string;
  readonly value: number | null;
}

export interface Signals {
  readonly time_ns: number;
  readonly signals: readonly SignalValue[];
}

export interface InputInfo {
  readonly name: string;
  readonly unit: string;
  readonly minimum: number | null;
  readonly maximum: number | null;
  readonly value: number | null; ///< null: never set so far
}

export interface EntryDeclaration {
  readonly index: string;
  readonly subindex: string;
  readonly name: string;
  readonly type: string;
  readonly access: string;
  readonly pdo: string;
  readonly unit: string;
  readonly minimum: string;
  readonly maximum: string;
  readonly default: string;
}

export type EntryValue = number | string | boolean | null;

export interface Entry extends EntryDeclaration {
  readonly value: EntryValue;
}

export interface EntryList<E = EntryDeclaration> {
  readonly device: string;
  readonly entries: readonly E[];
}

export type Severity = "information" | "refusal" | "warning" | "fault" | string;

export interface EventInfo {
  readonly number: number;
  readonly time_ns: number;
  readonly device: string;
  readonly rule: string;
  readonly severity: Severity;
  readonly text: string;
}

export interface Port {
  readonly number: number;
  readonly link: boolean;
  readonly loop_closed: boolean;
  readonly neighbour: string | null;
  readonly invalid_frames: number;
  readonly rx_errors: number;
  readonly forwarded_errors: number;
  readonly lost_links: number;
}

export interface SegmentDevice {
  readonly name: string;
  readonly after: string | null;
  readonly port: number | null;
  readonly entry_port: number;
  readonly ports: readonly Port[];
}

export interface Segment {
  readonly name: string;
  readonly link: string;
  readonly redundant: boolean;
  readonly carrier: readonly boolean[];
  readonly devices: readonly SegmentDevice[];
}

export interface Bus {
  readonly name: string;
  readonly bit_rate: number | null; ///< bit/s; null: unlimited
  readonly load: number;
  readonly ports: readonly string[];
  readonly devices: readonly string[];
}

export interface Line {
  readonly link: string;
  readonly devices: readonly string[];
}

export interface Wiring {
  readonly segments: readonly Segment[];
  readonly buses: readonly Bus[];
  readonly lines: readonly Line[];
}

export interface Led {
  readonly name: string;
  readonly colour: "green" | "red" | string;
  readonly pattern: string;
}

export interface AxisPanel {
  readonly name: string;
  readonly machine: string | null; ///< null: it is none of CiA 402
  readonly state: string | null;
  readonly mode?: number | null;
  readonly mode_name?: string | null;
  readonly signals: Readonly<Record<string, string>>;
  readonly last_refusal: EventInfo | null;
}

export interface NetworkPanel {
  readonly machine: string;
  readonly state: string;
  readonly status_code?: number | null;
  readonly status_text?: string | null;
}

export interface Panel {
  readonly leds: readonly Led[];
  readonly network: NetworkPanel | null;
  readonly axes: readonly AxisPanel[];
  readonly last_refusal: EventInfo | null;
  readonly program: boolean;
}

export interface Transition {
  readonly from: string;
  readonly to: string;
  readonly number: string;
  readonly event: string;
}

export interface StateMachine {
  readonly name: string;
  readonly title: string;
  readonly states: readonly string[];
  readonly transitions: readonly Transition[];
}

export interface Program {
  readonly running: boolean;
  readonly line: number | null;
  readonly lines: readonly { readonly address: number; readonly text: string }[];
}

export interface Frame {
  readonly number: number;
  readonly time_ns: number;
  readonly network: string;
  readonly direction: "request" | "answer" | "bus" | string;
  readonly summary: string;
  readonly fields: readonly (readonly [string, string])[];
  readonly raw: string;
}

export interface FaultParameter {
  readonly name: string;
  readonly type: string;
  readonly unit: string;
  readonly minimum: number | null;
  readonly maximum: number | null;
  /// As a rack file would say it; empty: none.
  readonly default: unknown;
  readonly summary: string;
  readonly choices?: readonly string[];
  readonly needed?: boolean;
}

export interface FaultKind {
  readonly name: string;
  readonly summary: string;
  readonly applies_to: string;
  readonly parameters: readonly FaultParameter[];
  /// What the master sees.
  readonly effect?: string;
  /// What "count" counts; empty: it takes none.
  readonly counts?: string;
  /// Over as soon as it has begun.
  readonly momentary?: boolean;
}

export interface FaultKinds {
  readonly kinds: readonly FaultKind[];
  /// Keys that faults of every kind have: name, begin, end.
  readonly common?: readonly FaultParameter[];
  /// Keys of "when", the milestone at which one begins.
  readonly when?: readonly FaultParameter[];
}

export interface Fault {
  readonly id: number | string;
  readonly kind: string;
  readonly target: string;
  readonly state: string;
  readonly name?: string;
  readonly remaining?: unknown;
  readonly hits?: number;
}

export interface SubscribedMessage {
  readonly type: "subscribed";
  readonly period_ns: number;
  readonly format?: "json" | "binary";
  readonly events?: boolean;
  readonly signals: readonly { readonly name: string; readonly unit: string }[];
}

export interface SamplesMessage {
  readonly type: "samples";
  readonly dropped: number;
  readonly time_ns: readonly number[];
  readonly values: readonly (readonly (number | null)[])[];
}

export interface ProblemMessage {
  readonly type: "problem";
  readonly problem: Problem;
}

export interface EventsMessage {
  readonly type: "events";
  readonly events: readonly EventInfo[];
}

export type SignalMessage = SubscribedMessage | SamplesMessage | EventsMessage | ProblemMessage;
