// What is large comes by address and not through viser's socket: it can be told of while it is under way, is kept for
// the next visit and is packed once for all visitors. The server leaves names in viser's messages (show/pieces.py);
// in viser's worker this puts the bytes in again. Runs before viser's script.
//
// viser's view may also have to wait: where the hall is full, the socket opens and nothing comes until it is this
// visitor's turn. `HALL.view.here` is true while the picture comes, `HALL.view.change` is called when that changes.
(() => {
  /** Runs in viser's worker, ahead of it: its socket hears lean messages and hands on whole ones. */
  function inWorker(channelName) {
    const SOONEST = 1000, LONGEST = 5000, LATEST = 30000; // [ms] pauses between attempts, the time one has
    const Plain = self.WebSocket;
    const channel = new BroadcastChannel(channelName);
    const asked = new Map(); // name -> {frame: promise, settle}

    function piece(name) {
      if (!asked.has(name)) {
        let settle = null;
        const frame = new Promise((done, fail) => {
          settle = (bytes) => (bytes ? done(new Uint8Array(bytes)) : fail(new Error(`no piece ${name}`)));
        });
        asked.set(name, { frame, settle });
        channel.postMessage({ ask: name });
      }
      return asked.get(name).frame;
    }
    channel.onmessage = ({ data }) => {
      asked.get(data.name)?.settle(data.bytes);
      asked.delete(data.name);
    };

    /** A message as viser sent it: size of the body, size of its frames, frames. */
    async function whole(data) {
      const bytes = new Uint8Array(data);
      if (String.fromCharCode(...bytes.subarray(0, 8)) !== "HALLLEAN") return data;
      const length = new DataView(data).getUint32(8, true);
      const { size, parts } = JSON.parse(new TextDecoder().decode(bytes.subarray(12, 12 + length)));
      let at = 12 + length;
      const frames = await Promise.all(
        parts.map((part) => (typeof part === "string" ? piece(part) : bytes.subarray(at, (at += part)))),
      );
      const packed = frames.reduce((sum, frame) => sum + frame.length, 0);
      const message = new Uint8Array(16 + packed);
      new DataView(message.buffer).setBigUint64(0, BigInt(size), true);
      new DataView(message.buffer).setBigUint64(8, BigInt(packed), true);
      let to = 16;
      for (const frame of frames) {
        message.set(frame, to);
        to += frame.length;
      }
      return message.buffer;
    }

    let newest = null; // viser's own idea of its socket; the real one, below, is ours
    let real = null, pause = SOONEST;
    let before = Promise.resolve(); // messages keep their order

    let told = false;
    function say(view) {
      if (view !== told) channel.postMessage({ view });
      told = view;
    }

    function hand(socket, data) {
      const message = whole(data);
      message.catch(() => {}); // it is met below, in its turn
      before = before
        .then(async () => {
          const bytes = await message;
          if (socket !== real) return;
          newest.onmessage?.({ data: bytes });
          pause = SOONEST;
          say(true);
        })
        .catch((error) => {
          console.error("the scene is incomplete:", error);
          socket.close(); // it comes anew
        });
    }

    /** Connect until it succeeds, with pauses that grow; an attempt has time, a browser may hold it back for seconds. */
    function connect() {
      const socket = (real = new Plain(newest.address, newest.protocols));
      socket.binaryType = "arraybuffer";
      const late = setTimeout(() => socket.close(), LATEST);
      socket.onopen = () => {
        clearTimeout(late);
        newest.onopen?.({}); // viser begins its scene anew
      };
      socket.onmessage = ({ data }) => hand(socket, data);
      socket.onclose = () => {
        clearTimeout(late);
        real = null;
        say(false);
        setTimeout(connect, pause);
        pause = Math.min(2 * pause, LONGEST);
      };
    }

    // What viser takes for its socket. viser gives one up after a second and asks for the next; to a browser each of
    // these has failed, and it lets the page wait ever longer, until none lives long enough to open. So viser never
    // hears of a loss: it only finds its socket opened once more.
    self.WebSocket = class {
      static OPEN = Plain.OPEN;
      constructor(address, protocols) {
        Object.assign(this, { address, protocols });
        const first = newest === null;
        newest = this;
        if (first) connect();
        else if (real?.readyState === Plain.OPEN) real.close(); // the last one has had the scene, this one needs it anew
      }
      get readyState() { return real?.readyState ?? Plain.CLOSED; }
      send(data) { real?.send(data); }
      close() {}
    };
  }

  const name = `hall-line-${performance.timeOrigin}-${Math.random()}`;
  const channel = new BroadcastChannel(name);
  const view = (window.HALL.view = { here: false, change: null });
  channel.onmessage = async ({ data: { ask, view: here } }) => {
    if (here !== undefined && here !== view.here) {
      view.here = here;
      view.change?.();
    }
    if (!ask) return;
    const bytes = await window.HALL.door.piece(ask).catch(() => null);
    channel.postMessage({ name: ask, bytes });
  };

  const Plain = window.Blob;
  window.Blob = class extends Plain {
    constructor(parts = [], options = {}) {
      const socket = parts.length === 2 && typeof parts[1] === "string" && parts[1].includes("WebSocket worker: got");
      super(socket ? [parts[0], `(${inWorker})(${JSON.stringify(name)});`, parts[1]] : parts, options);
    }
  };
})();
