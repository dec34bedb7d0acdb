"use strict";
const design = JSON.parse(document.getElementById("design").textContent);
const byId = (id) => document.getElementById(id);
const reduced = matchMedia("(prefers-reduced-motion: reduce)").matches;

// Every corner of a panel is A + B exp(-i phi) in the frame of its neighbour: a panel turns by -a or +a, 2 a = pi - phi,
// and is carried by a constant vector that turns the other way.
// A sheet of several has its own angle and turn, and moves from its place while flat to that over its target.
function sheetOf(part) {
  return design.sheets ? design.sheets[part[3]] : [design.phi, design.turn, 0, 0, 0, 0];
}

function turns(sheet, share) {
  const a = (Math.PI - sheet[0]) / 2 * share;
  const back = sheet[0] < Math.PI ? sheet[1] * (1 - share) : 0;
  return [back - a, back + a];
}

function corners(part, share) {
  const [odd, carried, own] = part;
  const sheet = sheetOf(part), left = 1 - share, both = turns(sheet, share);
  const [turn, other] = odd ? [both[1], both[0]] : both;
  const [c, s, cc, ss] = [Math.cos(turn), Math.sin(turn), Math.cos(other), Math.sin(other)];
  const x = cc * carried[0] - ss * carried[1] + sheet[2] + left * (sheet[4] - sheet[2]);
  const y = ss * carried[0] + cc * carried[1] + sheet[3] + left * (sheet[5] - sheet[3]);
  const found = [];
  for (let k = 0; k < own.length; k += 2)
    found.push(x + c * own[k] - s * own[k + 1], y + s * own[k] + c * own[k + 1]);
  return found;
}

function path(points) {
  let text = "";
  for (let k = 0; k < points.length; k += 2)
    text += (k ? "L" : "M") + points[k].toFixed(3) + " " + (-points[k + 1]).toFixed(3);
  return text + "Z";
}

if (window.self !== window.top) document.documentElement.classList.add("framed");

let share = 0;          // 0 flat, 1 over the target
let playing = 0;

function angle() { return Math.PI + (design.phi - Math.PI) * share; }

function draw() {
  const phi = angle();
  const texts = ["", ""];
  design.parts.forEach((part, k) => {
    const text = path(corners(part, share));
    texts[part[0]] += text;
    if (prints.length) {
      const sheet = sheetOf(part), both = turns(sheet, share);
      const [turn, other] = part[0] ? [both[1], both[0]] : both;
      const flat = turns(sheet, 0)[0];
      const t = turn - flat;
      const x = (Math.cos(other) - Math.cos(turn)) * part[1][0] - (Math.sin(other) - Math.sin(turn)) * part[1][1];
      const y = (Math.sin(other) - Math.sin(turn)) * part[1][0] + (Math.cos(other) - Math.cos(turn)) * part[1][1];
      prints[k].setAttribute("transform", `translate(${x.toFixed(3)} ${(-y).toFixed(3)}) rotate(${(-t * 180 / Math.PI).toFixed(4)})`);
    }
  });
  byId("even").setAttribute("d", texts[0]);
  byId("odd").setAttribute("d", texts[1]);
  byId("angle").value = share;
  byId("shown").textContent = "\u03c6 " + (phi * 180 / Math.PI).toFixed(0) + "\u00b0";
}

function show(next) { share = Math.min(Math.max(next, 0), 1); draw(); }

function stop() { cancelAnimationFrame(playing); playing = 0; byId("play").textContent = byId("play").dataset.play; }

function play() {
  if (playing) { stop(); return; }
  byId("play").textContent = byId("play").dataset.pause;
  const from = share < 1 ? share : 0, seconds = reduced ? 6 : 3;
  let begun = null;
  const frame = (now) => {
    begun = begun === null ? now : begun;
    const t = Math.min((now - begun) / 1000 / (seconds * (1 - from)), 1);
    show(from + (1 - from) * (0.5 - 0.5 * Math.cos(Math.PI * t)));
    if (t < 1) playing = requestAnimationFrame(frame); else stop();
  };
  playing = requestAnimationFrame(frame);
}

function saveProject() {
  const bytes = Uint8Array.from(atob(byId("project").textContent.trim()), (one) => one.charCodeAt(0));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  link.download = design.file;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function element(name, attributes, parent) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  parent.appendChild(made);
  return made;
}

// A print lies on the flat sheet and is cut into panels, which take their part of it with them.
const prints = [];
if (design.print) {
  const group = element("g", {}, byId("sheet"));
  element("image", { id: "print", href: byId("picture").textContent, ...design.print }, element("defs", {}, group));
  design.parts.forEach((part, k) => {
    const clip = element("clipPath", { id: "c" + k }, group);
    element("path", { d: path(corners(part, 0)) }, clip);
    const panel = element("g", {}, group);
    element("use", { href: "#print", "clip-path": `url(#c${k})` }, panel);
    prints.push(panel);
  });
  byId("sheet").appendChild(byId("target"));
}

byId("angle").addEventListener("input", (event) => { stop(); show(Number(event.target.value)); });
byId("play").addEventListener("click", play);
byId("print-page").addEventListener("click", () => print());
byId("outline").addEventListener("change", (event) => { byId("target").style.display = event.target.checked ? "" : "none"; });
byId("save").addEventListener("click", saveProject);
for (const name of ["even", "odd"])
  byId("colour-" + name).addEventListener("input", (event) => {
    document.documentElement.style.setProperty("--" + name, event.target.value);
  });
document.querySelectorAll("[data-share]").forEach((button) =>
  button.addEventListener("click", () => { stop(); show(Number(button.dataset.share)); }));
let drag = null;
byId("sheet").addEventListener("pointerdown", (event) => {
  stop();
  drag = [event.clientX, share];
  byId("sheet").setPointerCapture(event.pointerId);
});
byId("sheet").addEventListener("pointermove", (event) => {
  if (drag) show(drag[1] + (event.clientX - drag[0]) / (0.6 * byId("sheet").clientWidth));
});
for (const end of ["pointerup", "pointercancel"]) byId("sheet").addEventListener(end, () => { drag = null; });
document.addEventListener("keydown", (event) => {
  if (["INPUT", "BUTTON", "SUMMARY"].includes(event.target.tagName)) return;
  const step = { ArrowRight: 0.02, ArrowUp: 0.02, ArrowLeft: -0.02, ArrowDown: -0.02 }[event.key];
  if (event.key === " ") play();
  else if (step) { stop(); show(share + step); }
  else return;
  event.preventDefault();
});
document.documentElement.style.setProperty("--width", design.size[0] + "mm");
document.documentElement.style.setProperty("--height", design.size[1] + "mm");
show(design.shown);
// It opens once by itself, unless its reader asked for less motion.
if (!reduced) requestAnimationFrame(play);
