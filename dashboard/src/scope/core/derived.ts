// Evaluates expressions sample by sample.
import { t } from "../../language";
import { ExpressionError, type Node } from "./expression";

/// Reads the present row; `time` in seconds.
type Kernel = (time: number) => number;

/// An expression over arrays of samples that come piece by piece. It keeps what derivative, integral
/// and the like need of the past, so it must see each row once and in order.
export class DerivedChannel {
  private row = 0;
  private inputs: readonly (Float64Array | null)[] = [];
  private readonly kernel: Kernel;

  /// `columnOf` gives the place of a channel among the inputs, -1 if there is no such channel.
  /// `period` is the sampling period in ns.
  constructor(
    node: Node,
    columnOf: (name: string) => number,
    private readonly period: number,
  ) {
    this.kernel = this.compile(node, columnOf);
  }

  /// Values of the next `rows` rows.
  push(times: Float64Array, inputs: readonly (Float64Array | null)[], rows: number): Float64Array {
    this.inputs = inputs;
    const values = new Float64Array(rows);
    for (this.row = 0; this.row < rows; ++this.row) {
      values[this.row] = this.kernel(times[this.row]! * 1e-9);
    }
    return values;
  }

  private compile(node: Node, columnOf: (name: string) => number): Kernel {
    switch (node.kind) {
      case "number": {
        const value = node.value;
        return () => value;
      }
      case "channel": {
        const column = columnOf(node.name);
        if (column < 0) {
          throw new ExpressionError(t('there is no channel "{name}"; add it first', { name: node.name }), node.position);
        }
        return () => {
          const values = this.inputs[column];
          return values ? values[this.row]! : NaN;
        };
      }
      case "negate": {
        const operand = this.compile(node.operand, columnOf);
        return (time) => -operand(time);
      }
      case "binary": {
        const left = this.compile(node.left, columnOf);
        const right = this.compile(node.right, columnOf);
        switch (node.operator) {
          case "+":
            return (time) => left(time) + right(time);
          case "-":
            return (time) => left(time) - right(time);
          case "*":
            return (time) => left(time) * right(time);
          case "/":
            return (time) => left(time) / right(time);
        }
      }
      // eslint-disable-next-line no-fallthrough -- every operator returns
      case "call": {
        const operand = this.compile(node.operands[0]!, columnOf);
        const second = node.operands[1];
        switch (node.name) {
          case "abs":
            return (time) => Math.abs(operand(time));
          case "sqrt":
            return (time) => Math.sqrt(operand(time));
          case "floor":
            return (time) => Math.floor(operand(time));
          case "round":
            return (time) => Math.round(operand(time));
          case "min": {
            const other = this.compile(second!, columnOf);
            return (time) => Math.min(operand(time), other(time));
          }
          case "max": {
            const other = this.compile(second!, columnOf);
            return (time) => Math.max(operand(time), other(time));
          }
          case "derivative":
            return derivative(operand);
          case "integral":
            return integral(operand);
          case "average":
            return average(operand, this.rowsOf(second!));
          case "delta":
            return delta(operand, this.rowsOf(second!));
        }
      }
    }
  }

  private rowsOf(span: Node): number {
    const kMost = 1 << 20;
    const seconds = span.kind === "number" ? span.value : NaN;
    return Math.min(kMost, Math.max(1, Math.round((seconds * 1e9) / this.period)));
  }
}

function derivative(operand: Kernel): Kernel {
  let lastTime = NaN;
  let lastValue = NaN;
  return (time) => {
    const value = operand(time);
    const slope = (value - lastValue) / (time - lastTime);
    lastTime = time;
    lastValue = value;
    return slope;
  };
}

function integral(operand: Kernel): Kernel {
  let sum = 0;
  let lastTime = NaN;
  let lastValue = NaN;
  return (time) => {
    const value = operand(time);
    if (Number.isNaN(value)) {
      return sum;
    }
    if (!Number.isNaN(lastValue)) {
      sum += 0.5 * (value + lastValue) * (time - lastTime);
    }
    lastTime = time;
    lastValue = value;
    return sum;
  };
}

/// Mean of the last `rows` values, of fewer at the beginning.
function average(operand: Kernel, rows: number): Kernel {
  const kept = new Float64Array(rows);
  let count = 0;
  let next = 0;
  let sum = 0;
  return (time) => {
    const value = operand(time);
    if (Number.isNaN(value)) {
      return NaN;
    }
    if (count === rows) {
      sum -= kept[next]!;
    } else {
      ++count;
    }
    kept[next] = value;
    sum += value;
    next = next + 1 === rows ? 0 : next + 1;
    if (next === 0) {
      sum = kept.reduce((total, each, i) => (i < count ? total + each : total), 0); // rounding does not add up
    }
    return sum / count;
  };
}

function delta(operand: Kernel, rows: number): Kernel {
  const kept = new Float64Array(rows).fill(NaN);
  let next = 0;
  return (time) => {
    const value = operand(time);
    const before = kept[next]!;
    kept[next] = value;
    next = next + 1 === rows ? 0 : next + 1;
    return value - before;
  };
}
