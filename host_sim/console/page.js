/* SPDX-License-Identifier: MIT */
/* The page's own controls: source, playing, comparing, renderer, what is taken away. */
"use strict";

const at = (id) => document.getElementById(id);

/* `stays`: until somebody closes it, or something else goes wrong. */
function notice(text, quiet, stays) {
  const box = at("notice");
  if (quiet && box.dataset.stays && !box.hidden) return;
  if (stays) box.dataset.stays = "yes";
  else delete box.dataset.stays;
  box.hidden = text === "";
  box.firstElementChild.textContent = text;
  box.dataset.serial = state.serial; /* no frame of an earlier state takes it away */
  box.classList.toggle("quiet", quiet);
}

function closeNotice() {
  delete at("notice").dataset.stays;
  notice("", true);
}

/* ------------------------------------------------------------------------------------------- source -- */

function sourceKey(source) {
  return source.scene ? "scene " + source.scene : "file " + source.folder + " " + source.path;
}

/* A copy that was made of another format is called as the file that it was made of. */
function nameOfFile(path) {
  return path.replace(/\.copy\.mha$/, "");
}

function nameOfSource(source) {
  return (source.scene ? source.scene + ", " + source.size + " voxels" : nameOfFile(source.path)) + ", from " + source.from;
}

function fillSources(hello) {
  const scenes = make("optgroup", { label: "Scenes" }), files = make("optgroup", { label: "Files" });
  for (const scene of hello.scenes)
    scenes.append(make("option", { value: "scene " + scene.name, text: scene.name + ": " + scene.title }));
  for (const file of hello.files)
    files.append(make("option", { value: "file " + file.folder + " " + file.path, text: nameOfFile(file.path) }));
  at("source").replaceChildren(scenes, ...(hello.files.length ? [files] : []));
  at("from").replaceChildren(...hello.places.map((place) => make("option", { value: place, text: place })));
}

function showChosenSource() {
  at("source").value = sourceKey(state.source);
  at("from").value = state.source.from;
  for (const label of document.querySelectorAll(".of-scene")) label.toggleAttribute("data-gone", !state.source.scene);
  if (!state.source.scene) return;
  at("size").value = String(state.source.size);
  at("volumes").value = String(state.source.volumes);
}

function takeSource() {
  const before = state.source;
  const [kind, first, ...rest] = at("source").value.split(" ");
  const from = at("from").value || "probe";
  if (kind === "scene") {
    const volumes = Math.round(numberIn(at("volumes").value, 1, 16, 1));
    state.source = { scene: first, size: Number(at("size").value), volumes, from };
  } else {
    state.source = { folder: Number(first), path: rest.join(" "), from };
  }
  state.play.index = 0;
  if (sourceKey(state.source) !== sourceKey(before)) forgetConsent();
  if (!sameSource({ ...state.source, from: before.from }, before)) Object.assign(state, { marks: [], box: [] }); /* they lie in another volume */
  showChosenSource();
  changed(false);
}

/* ------------------------------------------------------------------------------------------ playing -- */

function showPlaying() {
  at("play").setAttribute("aria-pressed", String(state.play.on));
  at("play").textContent = state.play.on ? "Freeze" : "Play";
  at("speed").value = String(state.play.speed);
  at("speed-text").textContent = short(state.play.speed) + " /s";
}

function play(on) {
  state.play.on = on && !at("player").hidden; /* one volume stands still */
  showPlaying();
  changed(false);
}

function stepBy(by) {
  const count = lastFigures ? lastFigures.source.volumes : 1;
  state.play.index = (state.play.index + by + count) % count;
  play(false);
}

/* ---------------------------------------------------------------------------------------- comparing -- */

/* The first lane with its primary parameter half way to the farther end: two results that are the same tell nothing. */
function otherLane() {
  const lane = { plugin: state.lanes[0].plugin, values: { ...state.lanes[0].values } };
  const param = lanes[0].params.find((p) => p.primary);
  if (!param) return lane;
  const value = valueOf(0, param), end = value - param.low < param.high - value ? param.high : param.low, step = sliderStep(param);
  lane.values[param.key] = short(param.low + Math.round((value + end - 2 * param.low) / 2 / step) * step) * 1;
  return lane;
}

function compare(how) {
  look.compare = how;
  at("compare").value = how;
  if (how === "off") state.lanes.length = 1;
  else if (state.lanes.length < 2) state.lanes.push(otherLane());
  if (how !== "off" && !lanes[1].params.length) lanes[1].params = lanes[0].params;
  layOut();
  buildControls();
  changed(false);
}

/* Another plugin beside SmartVis at its defaults, and back. */
function compareWithOurs() {
  const ours = plugins.findIndex((plugin) => plugin.ours);
  if (state.lanes[1]?.plugin === ours) return compare("off");
  state.lanes[1] = { plugin: ours, values: {} };
  compare("side");
}

function showOurs() {
  const ours = plugins.findIndex((plugin) => plugin.ours);
  at("ours").hidden = ours < 0 || state.lanes[0].plugin === ours;
  at("ours").setAttribute("aria-pressed", String(state.lanes[1]?.plugin === ours));
}

/* ----------------------------------------------------------------------------------------- renderer -- */

const RENDER_FIELDS = [
  ["exposure", "Exposure", 0.1, 4, 0.05], ["ghost_width", "Ghosting, width [steps]", 0, 64, 1],
  ["ghost_offset", "Ghosting, offset [steps]", -64, 64, 1], ["ghost_doubt", "Ghosting, more where unsure", 0, 16, 0.5],
  ["t_low", "Transparent below", 0, 1, 0.005], ["t_high", "Opaque above", 0, 1, 0.005],
];

function renderField(label, value, low, high, step, take) {
  const input = make("input", { type: "range", min: String(low), max: String(high), step: String(step) });
  const output = make("output", { text: inSteps(value, step) });
  input.value = String(value);
  input.addEventListener("input", () => {
    take(Number(input.value));
    output.textContent = inSteps(Number(input.value), step);
    changed(true);
  });
  return make("div", { class: "param plain" }, make("label", {}, make("span", { text: label }), input, output));
}

function buildRenderer() {
  const box = at("render-controls"), r = state.render;
  const looks = make("select", {}, make("option", { value: "lit", text: "lit" }), make("option", { value: "thesis", text: "thesis" }));
  looks.value = r.look;
  at("lamp").disabled = r.look !== "lit";
  if (at("lamp").disabled && brush.on === "lamp") chooseBrush("lamp");
  looks.addEventListener("change", () => {
    r.look = looks.value;
    r.exposure = r.look === "thesis" ? 1.5 : 1;
    buildRenderer();
    changed(false);
  });
  box.replaceChildren(make("label", {}, make("span", { text: "Look" }), looks));
  if (r.look === "lit") {
    box.append(renderField("Lamp to the right [degrees]", r.light[0], -180, 180, 1, (v) => { r.light[0] = v; }));
    box.append(renderField("Lamp above [degrees]", r.light[1], -90, 90, 1, (v) => { r.light[1] = v; }));
  }
  for (const [key, label, low, high, step] of RENDER_FIELDS)
    box.append(renderField(label, r[key], low, high, step, (v) => { r[key] = v; }));
}

/* ---------------------------------------------------------------------------------------- take away -- */

/* The pictures that there are. */
function offerPictures() {
  const select = at("snapshot-view"), before = select.value;
  const there = VIEW_NAMES.filter((view) => (view !== "truth" || hasTruth) && (view !== "other" || look.compare !== "off"));
  select.replaceChildren(...there.map((view) => make("option", { value: view, text: TITLES[view] })));
  if (there.includes(before)) select.value = before;
}

let asked = null; /* the state in which a picture was asked for: a hand may have gone on since */

function askForPicture(suffix = "png") {
  asked = { ...structuredClone(state), suffix };
  send({ type: "do", what: "snapshot", view: at("snapshot-view").value });
}

async function savePicture(view, picture) {
  const { suffix } = asked, png = at("with-caption").checked ? await captioned(picture, wordsOf(view, asked), view, asked) : picture;
  const file = suffix === "dcm" ? await dicomOf(png, asked) : png;
  if (file) save(file, view, suffix);
}

function save(blob, what, suffix = "png") {
  const { scene, path } = lastFigures.of.source;
  const name = [scene || nameOfFile(path).split("/").pop(), what].join("_").replace(/[^\w.-]/g, "_") + "." + suffix;
  const link_ = make("a", { href: URL.createObjectURL(blob), download: "smartvis_" + name });
  document.body.dataset.snapshot = blob.size;
  link_.click();
  setTimeout(() => URL.revokeObjectURL(link_.href), 10000);
}

/* A page that came without TLS has no clipboard, and a browser may refuse it. */
async function copyFrom(field) {
  let copied = true;
  try {
    await navigator.clipboard.writeText(field.value);
  } catch {
    field.select();
    copied = document.execCommand("copy");
  }
  at("copied").textContent = copied ? "copied" : "The browser lets nothing be copied here. It is marked: Ctrl+C copies it.";
  if (copied) setTimeout(() => { at("copied").textContent = ""; }, 2000);
}

/* -------------------------------------------------------------------------------------------- start -- */

function takeHello(hello) {
  link.retry = 500;
  link.hello = hello;
  plugins = hello.plugins;
  brush.most = hello.marks.most;
  fillSources(hello);
  offerDicom();
  offerCines();
  const left = document.body.dataset.ready ? [] : readAddress(hello, location.hash.slice(1));
  if (!document.body.dataset.ready) setRadius(hello.marks.radius);
  document.body.dataset.ready = "yes";
  lanes.forEach((lane) => { lane.params = []; });
  showPlaying();
  showSettings();
  changed(false);
  tellWhatWasLeft(left, ownPresets().left);
}

function tellWhatWasLeft(ofAddress, presets) {
  const said = ofAddress.length ? ["The address says what is no setting here: " + ofAddress.join(", ") + "."] : [];
  if (presets) said.push("What this browser keeps as own presets is of another shape.");
  if (said.length) notice(said.join(" ") + " It is left out.", false, true);
}

/* What an address says may fit no volume: then the volume is shown without it, or the first scene. */
function startWithLess(text) {
  const bare = { camera: { yaw: 0, pitch: 0, roll: 0, zoom: 1 }, lanes: [{ plugin: 0, values: {} }], thick: 0, marks: [], box: [], render: structuredClone(usualRender) };
  if (lastFigures || link.less > 1) return;
  link.less += 1;
  Object.assign(state, bare, link.less > 1 ? { source: { scene: "D01", size: 128, volumes: 1, from: "probe" } } : {});
  look.compare = "off";
  showSettings();
  changed(false);
  notice(text, false, true);
}

/* All controls as the settings are now. */
function showSettings() {
  at("plane").value = look.plane;
  at("third").value = look.third;
  at("compare").value = look.compare;
  at("wipe").value = String(look.wipe);
  at("layout").value = look.layout;
  showGrey();
  showThick();
  showTurned();
  showChosenSource();
  buildRenderer();
  layOut();
  drawBox();
  buildControls();
}

function leaveTool() {
  if (cine.on) return void toggleCine();
  leaveBox();
  if (brush.on) chooseBrush(brush.on);
  if (!measured.on) return;
  if (!measured.made.every(isWhole)) measured.made = measured.made.filter(isWhole);
  else measured.on = "";
  measure(measured.on);
}

/* Nothing is done to slices that are not seen. */
function toSlices(change) {
  if (showsSlices()) change(slicesToTurn());
}

function onKey(event) {
  const where = event.target;
  if (event.key === "Escape") at("notice").hidden ? leaveTool() : closeNotice();
  if (event.altKey || where.matches("input[type=number], input[type=text], textarea, select")) return;
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
    event.preventDefault();
    at(event.shiftKey ? "redo" : "undo").click();
  }
  if (event.ctrlKey || event.metaKey) return;
  const next = { off: "side", side: "wipe", wipe: "off" };
  const keys = {
    m: nextMeasure, Delete: forgetLast, r: () => toSlices(quarterTurn), i: () => toSlices(flip), e: () => chooseBrush("remove"), k: () => chooseBrush("keep"), b: toggleBox, l: () => at("lamp").click(), f: () => play(!state.play.on),
    "[": () => nudgePrimary(-1), "]": () => nudgePrimary(1), ",": () => stepBy(-1), ".": () => stepBy(1),
    c: () => compare(next[look.compare]), v: () => setLayout(LAYOUTS[(LAYOUTS.indexOf(look.layout) + 1) % LAYOUTS.length]),
  };
  if (event.key === " " && !where.matches("button, input, summary, a")) keys[" "] = () => play(!state.play.on);
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
}

function listen() {
  for (const id of ["source", "size", "volumes", "from"]) at(id).addEventListener("change", takeSource);
  at("play").addEventListener("click", () => play(!state.play.on));
  at("step").addEventListener("click", () => stepBy(1));
  at("back").addEventListener("click", () => stepBy(-1));
  at("index").addEventListener("input", () => { state.play.index = Number(at("index").value); play(false); });
  at("speed").addEventListener("input", () => { state.play.speed = Number(at("speed").value); showPlaying(); changed(false); });
  at("layout").addEventListener("change", () => setLayout(at("layout").value));
  at("plane").addEventListener("change", () => { look.plane = at("plane").value; layOut(); changed(false); });
  at("third").addEventListener("change", () => { look.third = at("third").value; layOut(); changed(false); });
  at("compare").addEventListener("change", () => compare(at("compare").value));
  at("measure").addEventListener("click", () => measure(measured.on ? "" : at("measure-of").value));
  at("measure-of").addEventListener("change", () => measure(at("measure-of").value));
  at("flip").addEventListener("click", () => flip(Object.keys(AXES)));
  at("quarter").addEventListener("click", () => quarterTurn(Object.keys(AXES)));
  at("box").addEventListener("click", toggleBox);
  document.addEventListener("pointerdown", () => noteHand(true), true);
  for (const end of ["pointerup", "pointercancel"]) document.addEventListener(end, () => noteHand(false));
  for (const id of ["remove", "keep", "lamp"]) at(id).addEventListener("click", () => chooseBrush(id));
  at("radius").addEventListener("input", () => setRadius(at("radius").value));
  for (const key of GREY) {
    at(key).addEventListener("input", () => setGrey(key, Number(at(key).value)));
    at(key).addEventListener("dblclick", () => setGrey(key, 1));
  }
  at("thick").addEventListener("input", () => setThick(Number(at("thick").value)));
  at("thick").addEventListener("dblclick", () => setThick(0));
  at("clear-marks").addEventListener("click", clearMarks);
  at("undo").addEventListener("click", () => goTo(undo.past, undo.future));
  at("redo").addEventListener("click", () => goTo(undo.future, undo.past));
  at("ours").addEventListener("click", compareWithOurs);
  at("wipe").addEventListener("input", () => setWipe(Number(at("wipe").value)));
  at("reset-view").addEventListener("click", resetCamera);
  at("snapshot").addEventListener("click", () => askForPicture());
  at("snapshot-dicom").addEventListener("click", () => askForPicture("dcm"));
  at("cine").addEventListener("click", toggleCine);
  at("write").addEventListener("click", () => send({ type: "do", what: "write" }));
  at("copy").addEventListener("click", () => copyFrom(at("line")));
  at("copy-report").addEventListener("click", () => copyFrom(at("report")));
  at("notice-away").addEventListener("click", closeNotice);
  document.addEventListener("keydown", onKey);
  setInterval(rate, 500);
}

listen();
buildBox();
connect();
