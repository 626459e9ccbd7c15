// What goes to the disk of whoever looks at the page.

/// Has the browser keep `content` as a file.
export function saveFile(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  const kLongEnough = 60_000; // for the browser to have taken it
  setTimeout(() => URL.revokeObjectURL(link.href), kLongEnough);
}
