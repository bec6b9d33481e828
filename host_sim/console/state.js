/* SPDX-License-Identifier: MIT */
/* What the page wants to see, as it is sent (docs/console.md), and how it is written behind the # of the address, which address.js reads. */
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
  thick: 0, /* mm of the slices; 0: one voxel */
  render: {},
  lanes: [{ plugin: 0, values: {} }],
  marks: [], /* x, y, z and radius in mm, 1: keep or 0: remove */
  box: [], /* mm: x, y, z of its lower corner and of its upper one; none: all of the volume */
};

/* What only the page knows of: how it shows what it has. */
const look = { layout: "quad", plane: "across", third: "truth", compare: "off", wipe: 50, gain: 1, contrast: 1, turned: { across: 0, along: 0, deep: 0 } };
const LAYOUTS = ["single", "dual", "quad", "slice", "all"];
const GREY = ["gain", "contrast"]; /* of the slices */

/* Numbers with no more digits than a reader needs. */
function short(value) {
  return String(Number(Number(value).toPrecision(9)));
}

function numberIn(text, low, high, usual) {
  const value = Number.parseFloat(text);
  return Number.isFinite(value) ? Math.min(high, Math.max(low, value)) : usual;
}

function laneText(lane) {
  const values = Object.entries(lane.values).map(([key, value]) => key + ":" + short(value));
  return [lane.plugin, ...values].join(",");
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
  if (state.thick) at.set("thick", short(state.thick));
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
  if (look.plane !== "across") at.set("plane", look.plane);
  if (look.third !== "truth") at.set("third", look.third);
  if (look.compare !== "off") at.set("compare", look.compare);
  if (look.wipe !== 50) at.set("wipe", look.wipe);
  if (look.layout !== "quad") at.set("layout", look.layout);
  for (const key of GREY) if (look[key] !== 1) at.set(key, short(look[key]));
  const turned = Object.values(look.turned);
  if (turned.some((x) => x)) at.set("turned", turned.join(","));
  history.replaceState(null, "", location.pathname + location.search + "#" + at.toString());
}
