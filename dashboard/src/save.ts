/// Gives a file to the browser to keep.
export function save(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  const kLongEnough = 60_000; // for the browser to have taken it
  setTimeout(() => URL.revokeObjectURL(link.href), kLongEnough);
}
