// The plan in the office: the exhibit is moved and turned on the drawing, and the numbers beside it say where it is.

const plan = document.getElementById("plan");
const own = document.getElementById("own");
const turn = document.getElementById("turn");
const field = (name) => document.getElementById(`place-place.${name}`);
const [x, z, facing] = ["x", "z", "facing"].map(field);
const STEP = 0.05; // [m]
const ANGLE = 5; // [degrees]

const number = (input) => Number.parseFloat(input.value) || 0;
const rounded = (value) => String(Math.round(value / STEP) * STEP).replace(/(\.\d\d)\d+$/, "$1");

function draw() {
  own.setAttribute("transform", `translate(${number(x)} ${number(z)}) rotate(${-number(facing)})`);
}

/** Where on the floor a pointer is [m]. */
function spot(event) {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(plan.getScreenCTM().inverse());
  return [at.x, at.y];
}

/** While `grip` is held, `move` gets the way from where it was taken to the exhibit, and where the pointer is [m]. */
function drag(grip, move) {
  let held = null; // from the pointer to the exhibit's middle [m]
  grip.addEventListener("pointerdown", (event) => {
    const [px, pz] = spot(event);
    held = [number(x) - px, number(z) - pz];
    grip.setPointerCapture(event.pointerId);
    event.preventDefault();
    event.stopPropagation();
  });
  grip.addEventListener("pointermove", (event) => {
    if (!held) return;
    move(held, spot(event));
    draw();
  });
  for (const end of ["pointerup", "pointercancel"]) grip.addEventListener(end, () => (held = null));
}

function shift([dx, dz], [px, pz]) {
  x.value = rounded(px + dx);
  z.value = rounded(pz + dz);
}

/** The front follows the pointer about the exhibit's middle, where it stays. */
function face(_, [px, pz]) {
  const angle = (Math.atan2(px - number(x), pz - number(z)) * 180) / Math.PI;
  facing.value = String((Math.round(angle / ANGLE) * ANGLE + 360) % 360);
}

/** Until the walk through the hall is done; then what came of it is put in, and what is written beside it stays. */
function listen(told) {
  const ask = (address) => fetch(address, { credentials: "same-origin" });
  const again = async () => {
    const answer = await ask(told.dataset.ask).catch(() => null);
    const found = answer?.ok ? await answer.json() : null;
    const later = found && found.reached !== null && (await ask(window.location.href).catch(() => null));
    if (!later?.ok) return void setTimeout(again, 1500);
    const page = new DOMParser().parseFromString(await later.text(), "text/html");
    const now = page.getElementById("reached");
    told.replaceChildren(...now.childNodes);
    told.dataset.state = now.dataset.state;
    if (now.dataset.ask) setTimeout(again, 1500); // changed once more meanwhile
  };
  setTimeout(again, 1500);
}

if (plan && own && x && z && facing) {
  for (const input of [x, z, facing]) input.addEventListener("input", draw);
  own.classList.add("is-free");
  drag(own, shift);
  drag(turn, face);
}
const told = document.getElementById("reached");
if (told?.dataset.ask) listen(told);
