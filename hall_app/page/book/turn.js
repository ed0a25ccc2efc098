// A model in the office, turned by hand: its triangles in a canvas over its picture, drawn when something changes.

const STEP = Math.PI / 12; // of a key or a button [radians]
const DRAG = 0.01; // [radians/pixel]
const FIELD = 28 * (Math.PI / 180); // as the picture is drawn [radians]
const HEAD = 16; // [bytes]
const AGAIN = 30; // times that a busy hall is asked
const PAUSE = 2000; // [ms] between two

const VERTEX = `#version 300 es
uniform mat4 view; uniform mat3 turn;
in vec3 position; in vec3 normal; in vec3 colour;
out vec3 facing; out vec3 tint;
void main() { facing = turn * normal; tint = colour; gl_Position = view * vec4(position, 1.0); }`;
const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 facing; in vec3 tint;
out vec4 seen;
void main() {
  vec3 n = normalize(facing) * (gl_FrontFacing ? 1.0 : -1.0);
  float light = 0.35 + 0.25 * n.y * 0.5 + 0.55 * max(0.0, dot(n, normalize(vec3(-0.4, 0.5, 0.77))));
  seen = vec4(pow(pow(tint, vec3(2.2)) * light * 1.25, vec3(1.0 / 2.2)), 1.0);
}`;

/** What the hall sends: corners, their normals and colours, triangles. */
function read(data) {
  const head = new DataView(data);
  if (data.byteLength < HEAD || head.getUint32(0) !== 0x48445348) throw new Error("no shape");
  const [corners, triangles, of] = [4, 8, 12].map((at) => head.getUint32(at, true));
  const normals = HEAD + corners * 12;
  const positions = new Float32Array(data, HEAD, corners * 3);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; i += 1) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  const middle = low.map((one, axis) => (one + high[axis]) / 2);
  return {
    positions, triangles, of, middle,
    radius: Math.hypot(...high.map((one, axis) => (one - low[axis]) / 2)) || 1,
    normals: new Int8Array(data, normals, corners * 4),
    colours: new Uint8Array(data, normals + corners * 4, corners * 4),
    faces: new Uint32Array(data, normals + corners * 8, triangles * 3),
  };
}

/** A function that draws it, seen from `yaw` and `pitch` [radians] at `near` times the usual distance. */
function painter(gl, shape) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error("no shader");
  gl.useProgram(program);
  const given = [
    ["position", shape.positions, gl.FLOAT, false, 12],
    ["normal", shape.normals, gl.BYTE, true, 4],
    ["colour", shape.colours, gl.UNSIGNED_BYTE, true, 4],
  ];
  for (const [name, values, type, normalised, stride] of given) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    const at = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, type, normalised, stride, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, shape.faces, gl.STATIC_DRAW);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0.8, 0.77, 0.72, 1);
  const [view, turn] = ["view", "turn"].map((name) => gl.getUniformLocation(program, name));
  return (yaw, pitch, near) => {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const r = [cy, 0, -sy, -sy * sp, cp, -cy * sp, sy * cp, sp, cy * cp]; // rows: right, up, towards the eye
    const away = (shape.radius / Math.sin(FIELD / 2)) * near;
    const [close, far] = [Math.max(away - 2 * shape.radius, shape.radius / 100), away + 2 * shape.radius];
    const scale = 1 / Math.tan(FIELD / 2);
    const wide = scale * (gl.drawingBufferHeight / gl.drawingBufferWidth);
    const moved = [0, 1, 2].map((row) => -[0, 1, 2].reduce((sum, k) => sum + r[row * 3 + k] * shape.middle[k], 0));
    moved[2] -= away;
    const [a, b] = [(far + close) / (close - far), (2 * far * close) / (close - far)];
    const whole = [];
    for (let k = 0; k < 4; k += 1) { // by columns, as WebGL wants them
      const [x, y, z] = [0, 1, 2].map((row) => (k < 3 ? r[row * 3 + k] : moved[row]));
      whole.push(wide * x, scale * y, a * z + (k === 3 ? b : 0), -z);
    }
    gl.uniformMatrix4fv(view, false, whole);
    gl.uniformMatrix3fv(turn, true, r);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.drawElements(gl.TRIANGLES, shape.faces.length, gl.UNSIGNED_INT, 0);
  };
}

/** Canvas and keys for one figure, in place of its picture. */
function show(figure, shape, words) {
  const picture = figure.querySelector("img");
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [960, 1200];
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) throw new Error("no WebGL");
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", `${picture.alt} – ${words.keys}`);
  const paint = painter(gl, shape);
  const at = { yaw: 0.35, pitch: 0.2, near: 1 };
  const draw = () => {
    at.pitch = Math.max(-1.55, Math.min(1.55, at.pitch));
    at.near = Math.max(0.2, Math.min(2, at.near));
    paint(at.yaw, at.pitch, at.near);
    Object.assign(canvas.dataset, { yaw: at.yaw.toFixed(3), pitch: at.pitch.toFixed(3), near: at.near.toFixed(3) });
  };
  const moves = {
    ArrowLeft: () => (at.yaw += STEP), ArrowRight: () => (at.yaw -= STEP),
    ArrowUp: () => (at.pitch += STEP), ArrowDown: () => (at.pitch -= STEP),
    "+": () => (at.near *= 0.8), "-": () => (at.near /= 0.8),
  };
  moves["="] = moves["+"];
  canvas.addEventListener("keydown", (event) => {
    const move = moves[event.key];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    move();
    draw();
    event.preventDefault();
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    at.yaw -= (event.clientX - held[0]) * DRAG;
    at.pitch += (event.clientY - held[1]) * DRAG;
    held = [event.clientX, event.clientY];
    draw();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (held = null));
  const keys = document.createElement("div");
  keys.className = "turning";
  for (const [key, sign, name] of [
    ["ArrowLeft", "←", words.left], ["ArrowRight", "→", words.right], ["ArrowUp", "↑", words.up],
    ["ArrowDown", "↓", words.down], ["+", "+", words.closer], ["-", "−", words.farther],
  ]) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", className: "plain", textContent: sign, title: name });
    button.setAttribute("aria-label", name);
    button.addEventListener("click", () => { moves[key](); draw(); });
    keys.append(button);
  }
  picture.replaceWith(canvas);
  canvas.after(keys);
  draw();
  return canvas;
}

/** The hall draws one at a time and lets few wait: who is one too many asks again. */
async function asked(address) {
  for (let tries = 0; ; tries += 1) {
    const answer = await fetch(address, { credentials: "same-origin" });
    if (answer.status !== 429 || tries === AGAIN) return answer;
    await new Promise((wait) => setTimeout(wait, PAUSE));
  }
}

for (const figure of document.querySelectorAll("figure[data-shape]")) {
  const words = JSON.parse(figure.dataset.words);
  const [begin, told] = [document.createElement("button"), document.createElement("p")];
  Object.assign(begin, { type: "button", className: "plain", textContent: words.turn });
  told.className = "quiet";
  told.setAttribute("role", "status");
  figure.append(begin);
  begin.addEventListener("click", async () => {
    begin.disabled = true;
    begin.after(told);
    told.textContent = words.coming;
    try {
      const answer = await asked(figure.dataset.shape);
      if (!answer.ok) throw new Error(String(answer.status));
      const shape = read(await answer.arrayBuffer());
      const canvas = show(figure, shape, words);
      begin.remove();
      told.textContent = shape.of > shape.triangles
        ? words.fewer.replace("{shown}", shape.triangles).replace("{of}", shape.of) : "";
      canvas.focus({ preventScroll: true });
    } catch {
      begin.disabled = false;
      told.textContent = words.failed;
    }
  });
}
