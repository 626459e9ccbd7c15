// Ends a WebSocket in silence.

/// Closes `socket`; one that is still connecting once it has connected, as browsers write an error to the console where a connection is
/// given up before it stands.
export function closeSocket(socket: WebSocket | null): void {
  if (socket?.readyState === WebSocket.CONNECTING) {
    socket.onopen = () => socket.close();
  } else {
    socket?.close();
  }
}
