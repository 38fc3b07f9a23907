"use strict";
// What a page says about designs: verdict, plots, table, parameters, provenance.

Flexor.states = { kept: "✓ kept", active: "● active", broken: "✗ BROKEN" };

Flexor.verdict = (design) => {
  const { h } = Flexor;
  const { verdict, warnings } = design;
  const say = verdict.failed
    ? `No equilibrium at some load: ${verdict.failed}.`
    : verdict.constraints.length === 0
      ? "No constraints are stated."
      : verdict.headline
        ? verdict.headline
        : verdict.feasible
          ? verdict.unchecked
            ? "Feasible as drawn: all constraints are kept. Errors within the tolerances are not checked here."
            : "Feasible: all constraints are kept."
          : "NOT FEASIBLE.";
  const none = verdict.constraints.length === 0 && !verdict.failed;
  const state = none ? "" : verdict.feasible && !verdict.headline.startsWith("NOT") ? "kept" : "broken";
  const rows = verdict.constraints.map((row) =>
    h(
      "tr",
      { class: row.state },
      h("td", {}, row.text),
      h("td", { class: "number" }, row.value),
      h("td", { class: "state" }, Flexor.states[row.state]),
      h("td", {}, row.place),
    ),
  );
  const snaps = verdict.snaps ? h("p", { class: "broken" }, `The path snaps ${verdict.snaps === 1 ? "once" : `${verdict.snaps} times`}.`) : null;
  return h(
    "div",
    { class: "verdict" },
    h("p", { class: `say ${state}`, role: "status" }, say),
    rows.length
      ? h(
          "table",
          {},
          h("thead", {}, h("tr", {}, ...["constraint", "worst", "", "where"].map((t) => h("th", { scope: "col" }, t)))),
          h("tbody", {}, ...rows),
        )
      : null,
    snaps,
    ...verdict.cautions.map(({ text, warns }) => h("p", { class: warns ? "broken" : "caution" }, text)),
    ...warnings.map((text) => h("p", { class: "warning" }, `⚠ ${text}`)),
  );
};

// Whom one of several sizes serves: a sentence and the wearers; null of other designs.
Flexor.serves = (given) => {
  const { h } = Flexor;
  if (!given) return null;
  const [sentence, wearers] = given;
  return h(
    "section",
    { "aria-label": "wearers" },
    h("h2", {}, "Wearers"),
    h("p", { id: "serves" }, sentence),
    wearers.length ? h("details", {}, h("summary", {}, "whom it serves"), h("ul", {}, ...wearers.map((name) => h("li", {}, name)))) : null,
  );
};

// A name whose line may break after a dot, and not within a word.
Flexor.breakable = (name) => name.split(/(?<=\.)/).flatMap((part) => [part, Flexor.h("wbr")]);

// A table of observables at one load; returns an element with a method `mark(step)`.
Flexor.observables = (designs) => {
  const { h } = Flexor;
  const several = designs.length > 1;
  const heads = ["", ...designs.flatMap((d) => (several ? [`${d.title}: now`, "largest"] : ["at this load", "largest along the path"]))];
  const cells = [];
  const rows = designs[0].table.map((row, i) =>
    h(
      "tr",
      {},
      h("th", { scope: "row", title: row.text }, ...Flexor.breakable(row.name)),
      ...designs.flatMap((design) => {
        const other = design.table[i];
        const now = h("td", { class: "number" });
        cells.push([now, other]);
        return [now, h("td", { class: "number" }, other.largest)];
      }),
    ),
  );
  const made = h(
    "table",
    { class: "observables" },
    h("thead", {}, h("tr", {}, ...heads.map((t) => h("th", { scope: "col" }, t)))),
    h("tbody", {}, ...rows),
  );
  made.mark = (step) => {
    for (const [cell, row] of cells) cell.textContent = row.values[Math.min(step, row.values.length - 1)];
  };
  return made;
};

Flexor.parameters = (designs) => {
  const { h, number } = Flexor;
  if (!designs[0].parameters.length) return null;
  const rows = designs[0].parameters.map(([label, , unit], i) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, ...Flexor.breakable(unit ? `${label} / ${unit}` : label)),
      ...designs.map((d) => h("td", { class: "number" }, number(d.parameters[i][1]))),
    ),
  );
  return h(
    "table",
    { class: "parameters" },
    h("thead", {}, h("tr", {}, h("th", {}), ...designs.map((d) => h("th", { scope: "col" }, d.title)))),
    h("tbody", {}, ...rows),
  );
};

Flexor.provenance = (rows) => {
  const { h } = Flexor;
  return h("dl", { class: "provenance" }, ...rows.flatMap(([name, text]) => [h("dt", {}, name), h("dd", {}, text)]));
};

// A slider over load steps with a button that plays them; calls `moved(step)`.
Flexor.stepper = (moved) => {
  const { h } = Flexor;
  let labels = [], timer = 0;
  const slider = h("input", { type: "range", min: 0, max: 0, step: 1, id: "step", "aria-label": "load step" });
  const output = h("output", { for: "step" });
  const play = h("button", { type: "button", id: "play" }, "▶ Play");
  const set = (step) => {
    slider.value = step;
    output.textContent = labels[step] || "";
    slider.setAttribute("aria-valuetext", labels[step] || "");
    moved(step);
  };
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = "▶ Play";
  };
  slider.addEventListener("input", () => {
    stop();
    set(Number(slider.value));
  });
  play.addEventListener("click", () => {
    if (timer) return stop();
    play.textContent = "■ Stop";
    timer = setInterval(() => set((Number(slider.value) + 1) % labels.length), 600);
  });
  const made = h("div", { class: "stepper" }, play, slider, output);
  made.labels = (texts, keep = false) => {
    const last = !labels.length || Number(slider.value) === labels.length - 1;
    labels = texts;
    slider.max = texts.length - 1;
    set(keep && !last ? Math.min(Number(slider.value), texts.length - 1) : texts.length - 1);
  };
  made.step = () => Number(slider.value);
  return made;
};

// Controls of the view: field, see-through, camera; `legend` is where the scale goes.
Flexor.viewControls = (view, legend, current) => {
  const { h } = Flexor;
  const fields = h("select", { id: "field" });
  const pick = () => {
    const name = fields.value;
    view.setField(name || null);
    legend.replaceChildren();
    const scale = view.scale();
    if (scale) legend.append(Flexor.legend(scale, view.arrays.get(scale.colours)));
    const key = Flexor.frictionKey(current());
    if (key) legend.append(key);
  };
  fields.addEventListener("change", pick);
  const colour = h("label", {}, "Colour ", fields);
  const through = h("input", { type: "checkbox", id: "through", onchange: () => view.setSeeThrough(through.checked) });
  const cameras = ["oblique", "side", "top", "front"].map((name) =>
    h("button", { type: "button", class: "camera", "data-from": name, onclick: () => view.look(name) }, name),
  );
  const made = h(
    "div",
    { class: "viewcontrols" },
    colour,
    h("label", {}, through, " See through"),
    h("span", { role: "group", "aria-label": "camera" }, ...cameras),
  );
  made.refresh = () => {
    const before = fields.value, scales = Object.entries(current().scene.scales);
    colour.hidden = !scales.length;
    const wanted = ["", ...scales.map(([name]) => name)];
    if ([...fields.options].map((o) => o.value).join() !== wanted.join()) {
      fields.replaceChildren(h("option", { value: "" }, "by part"), ...scales.map(([name]) => h("option", { value: name }, name)));
      if (wanted.includes(before)) fields.value = before;
    }
    pick();
  };
  return made;
};

// Everything below the view for some designs; returns elements with a method `mark(step)`.
Flexor.report = (designs) => {
  const { h } = Flexor;
  const charts = designs[0].plots.map((_, i) => Flexor.chart(i, designs));
  const table = Flexor.observables(designs);
  const made = h("div", { class: "charts" }, ...charts);
  return {
    charts: made,
    table,
    mark: (step) => [...charts, table].forEach((each) => each.mark(step)),
  };
};
