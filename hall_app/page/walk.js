// Walking: the page predicts on the clearance grid, the server simulates every input again and is the authority.
// Without page hooks or grid (or with `hall serve --walk server`) the server walks and the page shows what it says.

import { Predictor } from "./walkmath.js";

const SEND_EVERY = 1 / 30; // [s]
const RETRY_AFTER = 1000; // [ms]
const RETRY_WHEN_FULL = 5000; // [ms]

/** `on` receives moved(pose), open(message), closed(), near(message), content(message), connection(state), heard(). */
export function createWalk({ scene, grid, display, mark, on }) {
  const pose = { x: scene.start.x, z: scene.start.z };
  const options = { speed: scene.walk.speed, radius: scene.walk.radius, skin: scene.walk.skin, maxDt: scene.walk.max_dt };
  let socket = null, mode = "server", predictor = null;
  let sequence = 0, outgoing = [];
  let arrived = false, sinceSent = 0, lastKeys = "", greeted = false;

  function send(message) {
    const ready = socket?.readyState === WebSocket.OPEN && (greeted || message.t === "hello");
    if (ready) socket.send(JSON.stringify(message));
    return ready;
  }

  function place({ x, z }) {
    pose.x = x;
    pose.z = z;
  }

  const receive = {
    hi(message) {
      greeted = true;
      on.connection("open");
      mode = message.mode;
      lastKeys = "";
      place(message);
      sequence = 0;
      outgoing = [];
      predictor = mode === "predict" && grid ? new Predictor(grid, { ...options, x: message.x, z: message.z }) : null;
      on.moved({ ...message, first: !arrived });
      arrived = true;
    },
    moved(message) {
      predictor?.teleport(message.x, message.z);
      place(message);
      on.moved(message);
    },
    pose(message) {
      if (predictor) predictor.acknowledge(message.seq, message.x, message.z);
      else place(message);
    },
    open: (message) => on.open(message),
    closed: (message) => on.closed(message),
    near: (message) => on.near(message),
    content: (message) => on.content(message),
  };

  function connect() {
    const address = new URL("/walk", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    socket = new WebSocket(address);
    socket.onopen = async () => {
      const client = await mark();
      const able = grid && display === "page" ? "predict" : "server";
      send({ t: "hello", client, display, able, at: arrived ? { x: pose.x, z: pose.z } : null });
    };
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      on.heard();
      receive[message.t]?.(message);
    };
    socket.onclose = (event) => {
      greeted = false;
      const full = event.code === 1013;
      on.connection(full ? "full" : "lost");
      setTimeout(connect, full ? RETRY_WHEN_FULL : RETRY_AFTER);
    };
  }

  /** Walk `dt` [s] in the page; long frames go in pieces the server takes. */
  function predict(dt, forward, right, yaw, eye) {
    const moving = forward !== 0 || right !== 0;
    if (!moving && !predictor.pending.length && !predictor.settling) return;
    for (let left = dt; left > 1e-6; left -= options.maxDt) {
      const part = Math.min(left, options.maxDt);
      sequence += 1;
      place(predictor.push({ seq: sequence, dt: part, forward, right, yaw, eye }));
      if (moving) outgoing.push([sequence, part, forward, right, yaw, eye]);
      else predictor.skip(sequence);
    }
  }

  /** One displayed frame: `dt` [s], intent in -1..1, heading [rad], eye height [m]. */
  function frame(dt, forward, right, yaw, eye) {
    if (predictor) predict(dt, forward, right, yaw, eye);
    sinceSent += dt;
    if (sinceSent < SEND_EVERY) return;
    sinceSent = 0;
    if (!predictor) hold(forward, right, yaw, eye);
    else if (outgoing.length) send({ t: "in", in: outgoing.splice(0) });
  }

  /** The server walks: tell it what is held, when that changes. */
  function hold(forward, right, yaw, eye) {
    const keys = JSON.stringify([forward, right, +yaw.toFixed(4), +eye.toFixed(3)]);
    if (keys === lastKeys) return;
    lastKeys = keys;
    send({ t: "keys", forward, right, yaw, eye });
  }

  connect();
  return {
    pose,
    frame,
    send,
    get mode() { return mode; },
    get disagreement() { return predictor?.worst ?? 0; }, // [m] largest so far between display and server
  };
}
