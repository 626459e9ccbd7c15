import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";

const kNudge = 300; ///< ms for which a click without pointer or key, as of a screen reader, holds the button

function holds(key: string): boolean {
  return key === " " || key === "Enter";
}

/// A button that does something from when it is pressed, by pointer, finger, space or enter, until it is let go. It
/// counts as let go, too, when it is disabled or the page is left.
export function HeldButton({
  label,
  disabled,
  onHold,
  onRelease,
  children,
}: {
  label: string;
  disabled: boolean;
  onHold: () => void;
  onRelease: () => void;
  children: ComponentChildren;
}) {
  const [held, setHeld] = useState(false);
  const state = useRef({ held, onRelease });
  state.current.onRelease = onRelease;
  const hold = () => {
    if (!state.current.held) {
      state.current.held = true;
      setHeld(true);
      onHold();
    }
  };
  const release = useRef(() => {
    if (state.current.held) {
      state.current.held = false;
      setHeld(false);
      state.current.onRelease();
    }
  }).current;
  useEffect(() => {
    if (disabled) {
      release();
    }
  }, [disabled, release]);
  useEffect(() => {
    window.addEventListener("blur", release);
    document.addEventListener("visibilitychange", release);
    return () => {
      window.removeEventListener("blur", release);
      document.removeEventListener("visibilitychange", release);
      release();
    };
  }, [release]);
  return (
    <button
      type="button"
      class={held ? "held-button held" : "held-button"}
      aria-label={label}
      disabled={disabled}
      onPointerDown={(event) => {
        if (event.button === 0) {
          event.currentTarget.setPointerCapture(event.pointerId);
          hold();
        }
      }}
      onPointerUp={release}
      onPointerCancel={release}
      onLostPointerCapture={release}
      onContextMenu={(event) => event.preventDefault()}
      onKeyDown={(event) => {
        if (holds(event.key)) {
          event.preventDefault();
          if (!event.repeat) {
            hold();
          }
        }
      }}
      onKeyUp={(event) => {
        if (holds(event.key)) {
          event.preventDefault();
          release();
        }
      }}
      onBlur={release}
      onClick={(event) => {
        if (event.detail === 0) {
          hold();
          setTimeout(release, kNudge);
        }
      }}
    >
      {children}
    </button>
  );
}
