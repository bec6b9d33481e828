/* SPDX-License-Identifier: MIT */
/* Controls drawn from a plugin's own description of its parameters. */
"use strict";

const lanes = [0, 1].map(() => ({ params: [], controls: new Map(), presets: [] }));
let plugins = [];

function valueOf(lane, param) {
  const values = state.lanes[lane] ? state.lanes[lane].values : {};
  return param.key in values ? values[param.key] : param.default;
}

function setValue(lane, param, value, hurried) {
  if (!state.lanes[lane] || !Number.isFinite(value)) return;
  const kept = clamp(value, param.min, param.max);
  if (kept === param.default) delete state.lanes[lane].values[param.key];
  else state.lanes[lane].values[param.key] = kept;
  refreshControls(lane);
  changed(hurried);
}

/* Whether the parameter matters with the values of now (sv_param_info.depends_on). */
function matters(lane, param, seen) {
  if (!param.depends_on) return true;
  const on = lanes[lane].params.find((p) => p.id === param.depends_on);
  if (!on || (seen || []).includes(on.id)) return true;
  const n = Math.round((valueOf(lane, on) - on.min) / (on.step || 1));
  return param.depends_values.includes(n) && matters(lane, on, (seen || []).concat(on.id));
}

/* A value with as many digits behind the point as its step has, nine at most. */
function inSteps(value, step) {
  let digits = 0;
  while (digits < 9 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) digits++;
  return value.toFixed(digits);
}

function shown(param, value) {
  return inSteps(value, sliderStep(param));
}

function nameOf(param, value) {
  const found = (param.names || []).find((n) => n.value === value);
  if (param.type === "bool") return value ? "on" : "off";
  return found ? found.name : shown(param, value) + (param.unit ? " " + param.unit : "");
}

function sliderStep(param) {
  if (param.type !== "float") return param.step || 1;
  return param.step > 0 ? param.step : Number(((param.high - param.low) / 200).toPrecision(1));
}

function slider(lane, param, id) {
  const input = make("input", {
    type: "range", id, min: String(param.low), max: String(param.high), step: String(sliderStep(param)),
  });
  input.addEventListener("input", () => setValue(lane, param, Number(input.value), true));
  return input;
}

function numberField(lane, param) {
  const input = make("input", {
    type: "number", min: String(param.min), max: String(param.max), "aria-label": param.label,
    step: param.type === "float" ? "any" : String(param.step || 1),
  });
  input.addEventListener("change", () => setValue(lane, param, Number(input.value), false));
  return input;
}

function picker(lane, param, id) {
  const input = make("select", { id });
  for (const one of param.names) input.append(make("option", { value: String(one.value), text: one.name }));
  input.addEventListener("change", () => setValue(lane, param, Number(input.value), false));
  return input;
}

function toggle(lane, param, id) {
  const input = make("input", { type: "checkbox", role: "switch", id });
  input.addEventListener("change", () => setValue(lane, param, input.checked ? 1 : 0, false));
  return input;
}

/* One parameter: name and default, what moves it, a way back, what must be known of it. */
function control(lane, param) {
  const id = "p" + lane + "-" + param.key;
  const kind = param.type === "bool" ? "toggle" : param.type === "enum" && param.names.length ? "picker" : "slider";
  const main = { toggle, picker, slider }[kind](lane, param, id);
  const field = kind === "slider" ? numberField(lane, param) : null;
  const reset = make("button", { type: "button", class: "reset", text: "↺", "aria-label": param.label + ": back to the default",
    title: "Back to " + nameOf(param, param.default) });
  reset.addEventListener("click", () => setValue(lane, param, param.default, false));
  const unit = param.unit && kind === "slider" ? " [" + param.unit + "]" : "";
  const name = make("span", { class: "name" }, make("label", { for: id, text: param.label + unit }),
    make("small", { text: "default " + nameOf(param, param.default) }));
  const note = make("span", { class: "note", id: id + "-note", text: param.help });
  main.setAttribute("aria-describedby", note.id);
  const row = make("div", { class: "param" + (kind === "picker" ? " wide" : ""), "data-key": param.key }, name, main);
  if (field) row.append(field);
  else if (kind === "toggle") row.append(make("span"));
  row.append(reset, note);
  lanes[lane].controls.set(param.key, { param, row, main, field, note, kind });
  return row;
}

/* The one parameter that every user sees, large. */
function primaryControl(lane, param) {
  const id = "primary" + lane;
  const main = slider(lane, param, id);
  const output = make("output", { for: id });
  const note = make("p", { class: "hint", id: id + "-note", text: param.help });
  const name = param.label + (state.lanes.length > 1 ? " " + "12"[lane] : "");
  main.setAttribute("aria-describedby", note.id);
  main.dataset.key = param.key;
  const box = make("div", { class: "primary" }, make("label", { for: id }, make("span", { text: name }), output), main, note);
  lanes[lane].controls.set(param.key, { param, row: box, main, output, note, kind: "slider" });
  return box;
}

function groupsOf(lane, params) {
  const box = make("div");
  const names = [...new Set(params.map((p) => p.group))];
  for (const name of names) {
    const set = make("fieldset", {}, make("legend", { text: name || "Parameters" }));
    for (const param of params.filter((p) => p.group === name)) set.append(control(lane, param));
    box.append(set);
  }
  return box;
}

function pluginPicker(lane) {
  const select = make("select", { "aria-label": "Plugin " + "12"[lane], id: "plugin" + lane });
  plugins.forEach((plugin, i) => {
    const text = plugin.failure ? plugin.name + " (cannot be loaded)" : plugin.name + " " + plugin.version;
    select.append(make("option", { value: String(i), text }));
  });
  select.value = String(state.lanes[lane].plugin);
  select.addEventListener("change", () => {
    state.lanes[lane] = { plugin: Number(select.value), values: {} };
    changed(false);
  });
  return select;
}

/* To clip although it is doubtful was said of one volume. */
function forgetConsent() {
  state.lanes.forEach((lane, i) => {
    if (!("unsure" in lane.values)) return;
    delete lane.values.unsure;
    refreshControls(i);
  });
}

function laneBox(lane) {
  const own = lanes[lane].params.filter((p) => !p.primary);
  const box = make("div", { class: "lane" });
  if (state.lanes.length > 1) box.append(make("h2", { text: "Settings " + "12"[lane] }));
  box.append(make("label", {}, make("span", { text: "Plugin" }), pluginPicker(lane)), presetBox(lane));
  box.append(groupsOf(lane, own.filter((p) => !p.expert)));
  const expert = own.filter((p) => p.expert);
  if (expert.length) box.append(make("details", {}, make("summary", { text: "Advanced" }), groupsOf(lane, expert)));
  return box;
}

/* Builds the controls of all lanes anew. */
function buildControls() {
  const first = document.getElementById("primary"), list = document.getElementById("lanes");
  first.replaceChildren();
  list.replaceChildren();
  state.lanes.forEach((_, lane) => {
    lanes[lane].controls.clear();
    lanes[lane].presets = [];
    const primary = lanes[lane].params.find((p) => p.primary);
    if (primary) first.append(primaryControl(lane, primary));
    list.append(laneBox(lane));
    refreshControls(lane);
  });
  showOurs();
}

function hideEmpty(lane) {
  for (const set of document.querySelectorAll("#lanes > .lane")[lane]?.querySelectorAll("fieldset") || [])
    set.hidden = ![...set.querySelectorAll(".param")].some((row) => !row.hidden);
}

/* Values as they are now, and only what matters with them. */
function refreshControls(lane) {
  for (const { param, row, main, field, output, kind } of lanes[lane].controls.values()) {
    const value = valueOf(lane, param);
    row.hidden = !matters(lane, param);
    row.classList.toggle("changed", value !== param.default);
    if (kind === "toggle") main.checked = value !== 0;
    else main.value = String(value);
    if (kind === "slider") main.setAttribute("aria-valuetext", nameOf(param, value));
    if (field && document.activeElement !== field) field.value = shown(param, value);
    if (output) output.textContent = nameOf(param, value);
  }
  for (const [button, values] of lanes[lane].presets)
    button.setAttribute("aria-pressed", String(sameValues(values, state.lanes[lane].values)));
  hideEmpty(lane);
}

function takePlugin(text) {
  if (state.lanes[text.lane]?.plugin !== text.plugin) return; /* another one was chosen since */
  lanes[text.lane].params = text.params;
  lanes[text.lane].activations = undefined;
  const plugin = plugins[text.plugin], values = state.lanes[text.lane].values;
  plugin.failure = text.failure;
  if (text.name) Object.assign(plugin, { name: text.name, version: text.version });
  for (const [key, value] of Object.entries(values)) {
    const param = text.params.find((p) => p.key === key);
    if (text.failure || (param && value >= param.min && value <= param.max)) continue; /* else a build has lost it */
    delete values[key];
    changed(false);
  }
  buildControls();
}

/* What a change cost that the plugin had to be activated for. */
function noteActivation(lane, figures) {
  const own = lanes[lane];
  const first = own.activations === undefined;
  if (!first && own.activations === figures.activations) return;
  own.activations = figures.activations;
  for (const { param, note } of own.controls.values()) {
    if (!param.reactivate) continue;
    const took = first ? "" : " (" + figures.activation_ms.toFixed(0) + " ms the last time)";
    note.textContent = param.help + " A change activates the plugin anew" + took + ".";
  }
}

/* The primary parameter by a key: a step of a fiftieth of what the slider spans. */
function nudgePrimary(direction) {
  const primary = lanes[0].params.find((p) => p.primary);
  if (!primary) return;
  const step = Math.max(sliderStep(primary), (primary.high - primary.low) / 50);
  setValue(0, primary, Number((valueOf(0, primary) + direction * step).toPrecision(12)), true);
}
