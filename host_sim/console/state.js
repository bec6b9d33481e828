/* SPDX-License-Identifier: MIT */
/* What the page wants to see, as it is sent (docs/console.md), and as it stands behind the # of the address. */
"use strict";

const RENDER_KEYS = ["look", "light", "t_low", "t_high", "ghost_width", "ghost_offset", "ghost_doubt", "exposure"];

const state = {
  type: "state",
  serial: 0,
  source: { scene: "D01", size: 128, volumes: 1, from: "probe" },
  camera: { yaw: 0, pitch: 0, roll: 0, zoom: 1 },
  views: [],
  picture: 512,
  draft: 256,
  hurried: false,
  play: { on: false, speed: 20, index: 0 },
  cross: [0.5, 0.5, 0.5],
  render: {},
  lanes: [{ plugin: 0, values: {} }],
  marks: [], /* x, y, z and radius in mm, 1: keep or 0: remove */
  box: [], /* mm: x, y, z of its lower corner and of its upper one; none: all of the volume */
};

/* What only the page knows of: how it shows what it has. */
const look = { layout: "quad", third: "truth", compare: "off", wipe: 50, gain: 1, contrast: 1 };
const LAYOUTS = ["single", "dual", "quad", "all"];
const GREY = ["gain", "contrast"]; /* of the slices */

/* Numbers with no more digits than a reader needs. */
function short(value) {
  return String(Number(Number(value).toPrecision(9)));
}

function numberIn(text, low, high, usual) {
  const value = Number.parseFloat(text);
  return Number.isFinite(value) ? Math.min(high, Math.max(low, value)) : usual;
}

function wordIn(text, words, usual) {
  return words.includes(text) ? text : usual;
}

function laneText(lane) {
  const values = Object.entries(lane.values).map(([key, value]) => key + ":" + short(value));
  return [lane.plugin, ...values].join(",");
}

function laneFrom(text) {
  const [plugin, ...values] = text.split(",");
  const lane = { plugin: numberIn(plugin, 0, 255, 0), values: {} };
  for (const one of values) {
    const [key, value] = one.split(":");
    const number = Number.parseFloat(value);
    if (/^[a-z0-9_]{1,63}$/.test(key) && Number.isFinite(number)) lane.values[key] = number;
  }
  return lane;
}

/* The renderer's usual settings, as the console told them. */
let usualRender = {};

/* Once a while at most: browsers refuse a page that writes it with every picture. */
let addressDue = 0;

function writeAddress() {
  addressDue = addressDue || setTimeout(writeAddressNow, 300);
}

function writeAddressNow() {
  addressDue = 0;
  const at = new URLSearchParams();
  const s = state.source;
  if (s.scene) at.set("scene", [s.scene, s.size, s.volumes].join(","));
  else at.set("file", s.folder + ":" + s.path);
  if (s.from !== "probe") at.set("from", s.from);
  const c = state.camera;
  if (c.yaw || c.pitch || c.roll || c.zoom !== 1) at.set("camera", [c.yaw, c.pitch, c.zoom, c.roll].map(short).join(","));
  if (state.play.index) at.set("volume", state.play.index);
  if (state.play.on) at.set("play", short(state.play.speed));
  if (state.cross.some((x) => x !== 0.5)) at.set("cross", state.cross.map(short).join(","));
  for (const key of RENDER_KEYS) {
    const now = String(state.render[key]);
    if (now !== String(usualRender[key])) at.set(key, now);
  }
  state.lanes.forEach((lane, i) => {
    const text = laneText(lane);
    if (text !== "0" || i > 0) at.set("ab"[i], text);
  });
  if (state.marks.length) at.set("marks", state.marks.map((mark) => mark.map(short).join(",")).join(";"));
  if (state.box.length) at.set("box", state.box.join(","));
  if (look.third !== "truth") at.set("third", look.third);
  if (look.compare !== "off") at.set("compare", look.compare);
  if (look.wipe !== 50) at.set("wipe", look.wipe);
  if (look.layout !== "quad") at.set("layout", look.layout);
  for (const key of GREY) if (look[key] !== 1) at.set(key, short(look[key]));
  history.replaceState(null, "", location.pathname + location.search + "#" + at.toString());
}

function readSource(at, hello) {
  const scene = (at.get("scene") || "").split(",");
  const file = /^(\d+):(.+)$/.exec(at.get("file") || "");
  const from = wordIn(at.get("from"), hello.places, "probe");
  if (file) return { folder: Number(file[1]), path: file[2], from };
  const name = wordIn(scene[0], hello.scenes.map((s) => s.name), "D01");
  const size = Math.round(numberIn(scene[1], 32, 256, 128));
  return { scene: name, size, volumes: Math.round(numberIn(scene[2], 1, 16, 1)), from };
}

function readRender(at) {
  const out = { ...usualRender };
  for (const key of RENDER_KEYS) {
    const text = at.get(key);
    if (text === null) continue;
    if (key === "look") out.look = wordIn(text, ["lit", "thesis"], "lit");
    else if (key === "light") out.light = [0, 1].map((i) => numberIn(text.split(",")[i], -180, 180, out.light[i]));
    else out[key] = numberIn(text, -256, 256, out[key]);
  }
  return out;
}

/* The address is read once, when the console has said what there is. */
function readAddress(hello) {
  const at = new URLSearchParams(location.hash.slice(1));
  usualRender = hello.render;
  state.source = readSource(at, hello);
  const camera = (at.get("camera") || "").split(",");
  state.camera = {
    yaw: numberIn(camera[0], -180, 180, 0),
    pitch: numberIn(camera[1], -90, 90, 0),
    zoom: numberIn(camera[2], 0.25, 16, 1),
    roll: numberIn(camera[3], -180, 180, 0),
  };
  state.play.index = Math.round(numberIn(at.get("volume"), 0, 1e6, 0));
  state.play.on = at.has("play");
  state.play.speed = numberIn(at.get("play"), 1, 50, 20);
  const cross = (at.get("cross") || "").split(",");
  state.cross = [0, 1, 2].map((i) => numberIn(cross[i], 0, 1, 0.5));
  state.render = readRender(at);
  state.marks = (at.get("marks") || "").split(";").map((mark) => mark.split(",").map(Number))
    .filter((mark) => mark.length === 5 && mark.every(Number.isFinite)).slice(0, hello.marks.most);
  const box = (at.get("box") || "").split(",").map(Number);
  state.box = box.length === 6 && box.every(Number.isFinite) ? box : [];
  state.lanes = [laneFrom(at.get("a") || "0")];
  look.compare = wordIn(at.get("compare"), ["off", "side", "wipe"], "off");
  if (look.compare !== "off") state.lanes.push(laneFrom(at.get("b") || at.get("a") || "0"));
  look.third = wordIn(at.get("third"), ["truth", "depthmap"], "truth");
  look.wipe = Math.round(numberIn(at.get("wipe"), 0, 100, 50));
  look.layout = wordIn(at.get("layout"), LAYOUTS, "quad");
  for (const key of GREY) look[key] = numberIn(at.get(key), 0.25, 4, 1);
}
