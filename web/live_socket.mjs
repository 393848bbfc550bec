// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The connection to the session: JSON text out; JSON text, and binary messages of a JSON header with
// blocks of numbers, in. docs/live.md has the format. Connects again when it is lost.

function unpack(buffer) {
  const view = new DataView(buffer);
  const length = view.getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let place = 4 + length;
  for (const block of header.blocks) {
    const type = block.type === "u4" ? Uint32Array : Float32Array;
    header[block.name] = new type(buffer, place, block.count);
    place += 4 * block.count;
  }
  return header;
}

// heard(message) for every message; status("open" | "lost" | "ended", reason).
export function connect(heard, status) {
  const address = `ws://${location.host}${location.pathname.replace(/[^/]*$/, "")}socket`;
  let socket = null;
  let ended = false;
  let wait = 500;

  function open() {
    socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      wait = 500;
      status("open");
    };
    socket.onmessage = (event) => {
      const message = typeof event.data === "string" ? JSON.parse(event.data) : unpack(event.data);
      if (message.type === "closing") ended = true;
      heard(message);
    };
    socket.onclose = (event) => {
      if (ended) return status("ended", "");
      status("lost", event.reason);
      setTimeout(open, wait);
      wait = Math.min(5000, 2 * wait);
    };
  }
  open();
  return {
    send(message) {
      if (socket.readyState !== WebSocket.OPEN) return false;
      socket.send(JSON.stringify(message));
      return true;
    },
  };
}
