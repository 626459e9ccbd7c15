/// Lines of 16 bytes: offset, bytes, printable characters.
export function hexDump(hex: string): string {
  const bytes = (hex.match(/[0-9a-fA-F]{2}/g) ?? []).map((pair) => parseInt(pair, 16));
  const lines: string[] = [];
  for (let i = 0; i < bytes.length; i += 16) {
    const row = bytes.slice(i, i + 16);
    const left = row.map((byte) => byte.toString(16).padStart(2, "0"));
    const text = row.map((byte) => (byte >= 0x20 && byte < 0x7f ? String.fromCharCode(byte) : "·")).join("");
    lines.push(
      `${i.toString(16).padStart(4, "0")}  ${left.slice(0, 8).join(" ").padEnd(23)}  ${left.slice(8).join(" ").padEnd(23)}  ${text}`,
    );
  }
  return lines.join("\n");
}
