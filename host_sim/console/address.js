/* SPDX-License-Identifier: MIT */
/* The state that an address says. Whoever sent it may have written anything: what is no setting is left out, and told. */
"use strict";

const KEY = /^[a-z0-9_]{1,63}$/; /* of a parameter */
const MOST_VALUES = 96, MOST_MM = 1e4; /* as console.h and console_message.c have them */
const RENDER_RANGES = { t_low: [0, 1], t_high: [0, 1], ghost_width: [0, 256], ghost_offset: [-256, 256], ghost_doubt: [0, 16], exposure: [0.1, 10] };

/* What is read of an address; `left` are the names of what is none. */
class Address {
  constructor(text) {
    this.given = new URLSearchParams(text);
    this.left = new Set();
  }

  /* Without the key, or with a value that is none: `usual`. */
  take(key, read, usual) {
    const text = this.given.get(key);
    const value = text === null ? null : read(text);
    if (text !== null && value === null) this.left.add(key);
    return value ?? usual;
  }

  word(key, words, usual) {
    return this.take(key, (text) => (words.includes(text) ? text : null), usual);
  }

  number(key, low, high, usual) {
    return this.take(key, (text) => numbersIn(text, [[low, high]])?.[0] ?? null, usual);
  }

  /* As many as there are ranges, or fewer: the rest is usual. */
  numbers(key, ranges, usual) {
    return this.take(key, (text) => {
      const found = numbersIn(text, ranges.slice(0, text.split(",").length));
      return found && [...found, ...usual.slice(found.length)];
    }, usual);
  }
}

/* Numbers with commas between, each in its range; null: they are not. */
function numbersIn(text, ranges) {
  const found = text.split(",").map((one) => (one.trim() === "" ? NaN : Number(one)));
  return found.length === ranges.length && found.every((x, i) => x >= ranges[i][0] && x <= ranges[i][1]) ? found : null;
}

function sourceIn(address, hello) {
  const from = address.word("from", hello.places, "probe");
  const file = address.take("file", (text) => /^(\d{1,2}):(.+)$/.exec(text), null);
  if (file) return { folder: Number(file[1]), path: file[2], from };
  const usual = ["D01", 128, 1];
  const [scene, size, volumes] = address.take("scene", (text) => {
    const [name, ...rest] = text.split(",");
    const numbers = rest.length ? numbersIn(rest.join(","), [[32, 256], [1, 16]].slice(0, rest.length)) : [];
    return numbers && hello.scenes.some((s) => s.name === name) ? [name, ...numbers.map(Math.round), ...usual.slice(1 + numbers.length)] : null;
  }, usual);
  return { scene, size, volumes, from };
}

function renderIn(address) {
  const out = { ...usualRender, look: address.word("look", ["lit", "thesis"], usualRender.look) };
  out.light = [...address.numbers("light", [[-180, 180], [-90, 90]], usualRender.light)];
  for (const [key, [low, high]] of Object.entries(RENDER_RANGES)) out[key] = address.number(key, low, high, out[key]);
  if (out.t_low < out.t_high) return out;
  address.left.add("t_low").add("t_high");
  return { ...out, t_low: usualRender.t_low, t_high: usualRender.t_high };
}

/* "0,q:0.5": a plugin and its values. */
function laneIn(address, key, count, usual) {
  return address.take(key, (text) => {
    const [plugin, ...pairs] = text.split(","), values = {};
    if (!numbersIn(plugin, [[0, count - 1]]) || !Number.isInteger(Number(plugin)) || pairs.length > MOST_VALUES) return null;
    for (const pair of pairs) {
      const [name, value, ...more] = pair.split(":");
      if (!KEY.test(name) || !value || more.length || !Number.isFinite(Number(value))) return null;
      values[name] = Number(value);
    }
    return { plugin: Number(plugin), values };
  }, usual);
}

function marksIn(address, most) {
  const mm = [-MOST_MM, MOST_MM];
  return address.take("marks", (text) => {
    const marks = text.split(";").map((mark) => numbersIn(mark, [mm, mm, mm, [0.1, 1e3], [0, 1]]));
    return marks.length <= most && marks.every((mark) => mark && Number.isInteger(mark[4])) ? marks : null;
  }, []);
}

function boxAt(address) {
  return address.take("box", (text) => {
    const ends = numbersIn(text, Array(6).fill([-MOST_MM, MOST_MM]));
    return ends && [0, 1, 2].every((k) => ends[k] < ends[k + 3]) ? ends : null;
  }, []);
}

const KNOWN = ["scene", "file", "from", "camera", "volume", "play", "cross", "thick", "light", "look", ...Object.keys(RENDER_RANGES), "a", "b", "marks", "box", "layout", "plane", "third",
  "compare", "wipe", "turned", ...GREY];

/* The address is read once, when the console has said what there is. Returns what was left out, by name. */
function readAddress(hello, text) {
  const address = new Address(text), share = [0, 1];
  usualRender = hello.render;
  state.source = sourceIn(address, hello);
  const [yaw, pitch, zoom_, roll_] = address.numbers("camera", [[-180, 180], [-90, 90], [0.25, 16], [-180, 180]], [0, 0, 1, 0]);
  state.camera = { yaw, pitch, zoom: zoom_, roll: roll_ };
  state.play.index = Math.round(address.number("volume", 0, 1e6, 0));
  state.play.speed = address.number("play", 1, 50, 20);
  state.play.on = address.given.has("play");
  state.cross = address.numbers("cross", [share, share, share], [0.5, 0.5, 0.5]);
  state.thick = address.number("thick", 0, 20, 0);
  state.render = renderIn(address);
  state.marks = marksIn(address, hello.marks.most);
  state.box = boxAt(address);
  const first = laneIn(address, "a", hello.plugins.length, { plugin: 0, values: {} });
  state.lanes = [first];
  look.layout = address.word("layout", LAYOUTS, "quad");
  look.compare = address.word("compare", ["off", "side", "wipe"], "off");
  if (look.compare !== "off") state.lanes.push(laneIn(address, "b", hello.plugins.length, structuredClone(first)));
  look.plane = address.word("plane", Object.keys(AXES), "across");
  look.third = address.word("third", ["truth", "depthmap"], "truth");
  look.wipe = Math.round(address.number("wipe", 0, 100, 50));
  const [across, along, deep] = address.numbers("turned", Array(3).fill([0, 7]), [0, 0, 0]).map(Math.round);
  look.turned = { across, along, deep };
  for (const key of GREY) look[key] = address.number(key, 0.25, 4, 1);
  for (const key of address.given.keys()) if (key && !KNOWN.includes(key)) address.left.add(key);
  return [...address.left].map((key) => key.slice(0, 30)).slice(0, 10);
}
