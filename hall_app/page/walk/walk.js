// Walking: the page predicts on the clearance grid, the server simulates every input again and is the authority.
// Without page hooks or grid (or with `hall serve --walk server`) the server walks and the page shows what it says.

import { PACE, Prediction } from "./prediction.js";

const SEND_EVERY = 1 / 30; // [s]
const RETRY_AFTER = 1000; // [ms]
const RETRY_AS = { full: 5000, refused: 60000 }; // [ms]
const CLOSED = { 1013: "full", 1008: "refused" };
const MARK_PATIENCE = 3000; // [ms] the hello does not wait longer: where the hall is full, viser's view comes after it
const PAGE = Array.from(crypto.getRandomValues(new Uint32Array(4)), (n) => n.toString(36)).join("."); // known again after a line that died
const REPEAT = 0.2; // [s] after which held keys are told again where the server walks: its answer is a sign of life
const clock = () => performance.now() / 1000; // [s]

/**
 * at: {x, z} [m] to come in at, null for the entrance. `on` receives moved(pose), open(message), compared(message),
 * closed(), near(message), turn(message), content(message), connection(state, place), heard().
 */
export function createWalk({ scene, grid, display, mark, at, on }) {
  const pose = { x: scene.start.x, z: scene.start.z };
  const options = { speed: scene.walk.speed, radius: scene.walk.radius, skin: scene.walk.skin, maxDt: scene.walk.max_dt };
  let socket = null, mode = "server", prediction = null;
  let held = new Held();
  let arrived = false, sinceSent = 0, walking = false, greeted = false, asked = false, waiting = false, introduced = false;
  let stood = false;

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
    queue: (message) => on.connection("queue", message.place),
    hi(message) {
      greeted = true;
      if (!introduced) introduce(socket);
      on.connection("open");
      waiting = false;
      mode = message.mode;
      place(message);
      held = new Held();
      prediction = mode === "predict" && grid ? new Prediction(grid, { ...options, x: message.x, z: message.z }, clock()) : null;
      on.moved({ ...message, first: !arrived });
      arrived = true;
      if (stood) send({ t: "stands" });
    },
    moved(message) {
      prediction?.moved(message.x, message.z);
      place(message);
      on.moved(message);
    },
    pose(message) {
      if (prediction) prediction.answer(message.seq, message.x, message.z, clock());
      else {
        held.answer(message.seq);
        place(message);
      }
      tellWaiting();
    },
    open: (message) => on.open(message),
    compared: (message) => on.compared(message),
    closed: (message) => on.closed(message),
    near: (message) => on.near(message),
    turn: (message) => on.turn(message),
    content: (message) => on.content(message),
  };

  function connect() {
    const address = new URL("/walk", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const own = (socket = new WebSocket(address));
    socket.onopen = async () => {
      const late = new Promise((done) => setTimeout(done, MARK_PATIENCE, null));
      const client = await Promise.race([mark(), late]);
      if (own !== socket) return;
      introduced = client !== null;
      const able = grid && display === "page" ? "predict" : "server";
      asked = true;
      send({ t: "hello", page: PAGE, client, display, able, at: arrived ? { x: pose.x, z: pose.z } : at });
    };
    socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      // The clock's ticks wake nobody: who rests looks once in a while whether anything turns in sight.
      if (message.t !== "turn") on.heard();
      receive[message.t]?.(message);
    };
    socket.onclose = (event) => {
      greeted = asked = false;
      const state = event.reason === "away" ? "away" : CLOSED[event.code] ?? "lost";
      on.connection(state);
      if (state === "away") comeBack();
      else setTimeout(connect, RETRY_AS[state] ?? RETRY_AFTER);
    };
  }

  /** The place was given to somebody who waited: ask for one again at the first sign that somebody is here. */
  function comeBack() {
    const signs = ["keydown", "pointerdown"];
    const back = () => {
      for (const sign of signs) removeEventListener(sign, back, true);
      connect();
    };
    for (const sign of signs) addEventListener(sign, back, true);
  }

  /** Tell which of viser's clients this page is, once it is one: to whom waited in the queue the view opens late. */
  async function introduce(own) {
    const here = () => own === socket && own.readyState === WebSocket.OPEN;
    let client = null;
    while (!client && here()) client = await mark();
    if (client && here()) send({ t: "client", client });
  }

  /** Tell the visitor that the hall does not answer, and that it does again. */
  function tellWaiting() {
    const now = greeted && (prediction ?? held).waiting;
    if (now === waiting) return;
    waiting = now;
    if (greeted) on.connection(waiting ? "waiting" : "open");
  }

  /** One displayed frame: `dt` [s], intent in -1..1, heading [rad], eye height [m]. */
  function frame(dt, forward, right, yaw, eye) {
    const moving = forward !== 0 || right !== 0;
    // Once the server has been asked for a new walk from here, here is where it begins.
    if (prediction && !(asked && !greeted)) place(prediction.walk(dt, forward, right, yaw, eye, clock()));
    else held.live(dt);
    tellWaiting();
    const stopped = walking && !moving; // the last step waits for no other
    walking = moving;
    sinceSent += dt;
    if (sinceSent >= SEND_EVERY || stopped) tell(forward, right, yaw, eye);
  }

  function tell(forward, right, yaw, eye) {
    sinceSent = 0;
    if (!greeted) return;
    if (prediction) {
      const inputs = prediction.take();
      if (inputs.length) send({ t: "in", in: inputs });
    } else if (held.change(forward, right, yaw, eye)) send({ t: "keys", forward, right, yaw, eye });
  }

  connect();
  return {
    pose,
    frame,
    /** Nothing is held any more, and no frame will say so: tell the server now. */
    stand(yaw, eye) { tell(0, 0, yaw, eye); },
    send,
    /** The first view is there, and what came after it: the next may come. */
    stands() {
      stood = true;
      send({ t: "stands" });
    },
    /** The floor has changed; without a grid of it the old one serves, and the server corrects. */
    change(next) {
      grid = next ?? grid;
      if (prediction) prediction.predictor.grid = grid;
    },
    get mode() { return mode; },
    get ahead() { return prediction?.ahead ?? 0; }, // [s] of walking shown that the server has not answered yet
    get disagreement() { return prediction?.predictor.worst ?? 0; }, // [m] largest so far between display and server
  };
}

/** The server walks: what it was told to be held, and whether it answers. */
class Held {
  #told = ""; #numbered = 0; #answered = 0; #since = 0; #silent = 0;

  live(dt) {
    this.#since += dt;
    if (this.#numbered > this.#answered) this.#silent += dt;
  }

  /** Whether these keys are to be told: they are others, or it is time for a sign of life while they walk. */
  change(forward, right, yaw, eye) {
    const keys = JSON.stringify([forward, right, +yaw.toFixed(4), +eye.toFixed(3)]);
    const walks = forward !== 0 || right !== 0;
    if (keys === this.#told && !(walks && this.#since >= REPEAT)) return false;
    this.#told = keys;
    this.#since = 0;
    this.#numbered += 1;
    return true;
  }

  answer(seq) {
    if (seq <= this.#answered) return;
    this.#answered = seq;
    this.#silent = 0;
  }

  get waiting() { return this.#silent >= PACE.patience; }
}
