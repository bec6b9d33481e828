/* SPDX-License-Identifier: MIT */
/* What one may start from: presets of SmartVis, and what a user has saved under names of his own. */
"use strict";

/* By keys of SmartVis; other plugins that have them all may start from these, too. */
const PRESETS = [
  ["Careful", "More stays in front of the fetus; nothing is removed where fluid is doubtful", { q: 0.75, unsure: "keep" }],
  ["Clear view", "Removes all it can, also where fluid is doubtful", { q: 0.25, unsure: "clip" }],
];
/* A cookie, not the page's storage: that belongs to a port, and the console has another one at every start. */
const OWN = "smartvis_presets=", OWN_BYTES = 2000;

/* The values of a preset that are no defaults; null if the plugin does not have all of them. */
function presetValues(lane, preset) {
  const values = {};
  for (const [key, wanted] of Object.entries(preset)) {
    const param = lanes[lane].params.find((p) => p.key === key);
    const value = typeof wanted === "string" ? param?.names?.find((n) => n.name === wanted)?.value : wanted;
    if (!param || !(value >= param.min && value <= param.max)) return null;
    if (value !== param.default) values[key] = value;
  }
  return values;
}

/* Other pages of this machine may write the cookie: only what a preset looks like is one. */
function isPreset([name, one]) {
  return name.length > 0 && name.length <= 30 && Array.isArray(one) && one.length === 2 && typeof one[0] === "string" && one[0] !== "" && one[1] !== null &&
    typeof one[1] === "object" && Object.entries(one[1]).every(([key, value]) => KEY.test(key) && Number.isFinite(value));
}

/* `own`, by name: the plugin's id and what was set of it. `left`: something there is no preset. */
function ownPresets() {
  const kept = document.cookie.split("; ").find((one) => one.startsWith(OWN));
  if (kept === undefined) return { own: {}, left: false };
  try {
    const all = JSON.parse(decodeURIComponent(kept.slice(OWN.length))), shaped = all !== null && typeof all === "object" && !Array.isArray(all);
    const found = shaped ? Object.entries(all) : [], own = found.filter(isPreset);
    return { own: Object.fromEntries(own), left: !shaped || own.length < found.length };
  } catch {
    return { own: {}, left: true };
  }
}

function keepOwn(all) {
  const text = encodeURIComponent(JSON.stringify(all));
  if (text.length > OWN_BYTES) return notice("There is no room for another preset: delete one.", false);
  document.cookie = OWN + text + "; path=/; max-age=31536000; SameSite=Strict";
  buildControls();
}

function takePreset(lane, name, values, id) {
  const { name: plugin, id: now } = plugins[state.lanes[lane].plugin];
  const known = !id || id === now ? presetValues(lane, values) : null;
  if (!known) return notice("\"" + name + "\" was saved with " + id + ", and does not fit " + plugin + ".", false);
  state.lanes[lane].values = known;
  refreshControls(lane);
  changed(false);
}

function presetBox(lane) {
  const box = make("p", { class: "presets", role: "group", "aria-label": "Start from" }, make("span", { text: "Start from" }));
  const name = make("input", { type: "text", maxlength: "30", placeholder: "own preset", "aria-label": "Name of an own preset" });
  const gone = make("button", { type: "button", text: "Delete", title: "The preset of this name" });
  const offerToDelete = () => { gone.disabled = !Object.hasOwn(ownPresets().own, name.value.trim()); };
  const add = (text, title, values, id) => {
    const button = make("button", { type: "button", text, title });
    button.addEventListener("click", () => {
      if (id) name.value = text;
      offerToDelete();
      takePreset(lane, text, values, id);
    });
    if (!id || id === plugins[state.lanes[lane].plugin].id) lanes[lane].presets.push([button, presetValues(lane, values) || values]);
    box.append(button);
  };
  for (const [text, title, values] of PRESETS) if (presetValues(lane, values)) add(text, title, values, "");
  for (const [text, [id, values]] of Object.entries(ownPresets().own)) add(text, "Saved with " + id, values, id);
  const save = make("button", { type: "button", text: "Save", title: "These settings, under this name, in this browser" });
  save.addEventListener("click", () => {
    if (name.value.trim()) keepOwn({ ...ownPresets().own, [name.value.trim()]: [plugins[state.lanes[lane].plugin].id, { ...state.lanes[lane].values }] });
    else name.focus();
  });
  gone.addEventListener("click", () => {
    const { [name.value.trim()]: _, ...rest } = ownPresets().own;
    keepOwn(rest);
  });
  name.addEventListener("input", offerToDelete);
  offerToDelete();
  box.append(name, save, gone);
  return box;
}

function sameValues(a, b) {
  return Object.keys(a).length === Object.keys(b).length && Object.keys(a).every((key) => a[key] === b[key]);
}
