// A button that copies a text, and says so.
import { useEffect, useState } from "preact/hooks";
import { t } from "../language";

const kShown = 2000;

/// False where pages may not use the clipboard: neither https nor loopback.
async function copy(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}

export function CopyButton({ text, name }: { text: string; name: string }) {
  const [said, setSaid] = useState("");
  useEffect(() => {
    if (said === "") {
      return undefined;
    }
    const timer = setTimeout(() => setSaid(""), kShown);
    return () => clearTimeout(timer);
  }, [said]);
  return (
    <>
      <button
        type="button"
        aria-label={t("Copy {name}", { name })}
        onClick={() => void copy(text).then((done) => setSaid(done ? t("Copied") : t("Select it and press Ctrl-C")))}
      >
        {t("Copy")}
      </button>
      <span class="soft" role="status">
        {said}
      </span>
    </>
  );
}
