export function DeviceView(_: Record<string, unknown>) { return <p class="empty">…</p>; }
