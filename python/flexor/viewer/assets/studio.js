"use strict";
// The page of `flexor studio`. All state is in this tab; every request says which design it is about.

(() => {
  const { h, number } = Flexor;
  const data = JSON.parse(document.getElementById("data").textContent);
  const token = new URLSearchParams(location.search).get("token");
  const arrays = new Map();
  const page = document.getElementById("page");

  // Requests.
  const ask = async (name, body, signal) => {
    const headers = { "Content-Type": "application/json" };
    if (token) headers.Authorization = `Bearer ${token}`;
    const answer = await fetch(`/api/${name}`, { method: "POST", headers, body: JSON.stringify(body), signal });
    if (answer.ok) return answer;
    const text = await answer.text();
    let said = text;
    try {
      said = JSON.parse(text).error;
    } catch {
      // Not JSON: shown as it is.
    }
    throw new Error(said);
  };
  const lines = async function* (name, body, signal) {
    const reader = (await ask(name, body, signal)).body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      rest += value;
      const parts = rest.split("\n");
      rest = parts.pop();
      for (const part of parts) {
        const row = JSON.parse(part);
        if (row.error) throw new Error(row.error);
        yield row;
      }
    }
  };

  // State: the design, those before and after it, and one that is kept for comparison.
  const initial = { values: data.variables.map((v) => v.start), loads: data.loads.map((l) => l.start) };
  const copy = (state) => ({ values: [...state.values], loads: [...state.loads] });
  let now = copy(initial);
  let past = [], future = [], kept = null, design = null;

  const message = h("p", { id: "message", role: "alert", class: "broken" });
  const say = (text = "") => {
    message.textContent = text;
  };
  const status = h("p", { id: "status", class: "soft" });

  // Sliders.
  const slider = (given, list, index) => {
    const { name, unit, low, high, step } = given;
    const id = `${list}-${index}`;
    const range = h("input", { type: "range", id, min: low, max: high, step: "any", "data-name": name });
    const box = h("input", { type: "number", min: low, max: high, step: "any", "aria-label": `${name}${unit ? ` in ${unit}` : ""}` });
    const put = (value, end) => {
      if (!Number.isFinite(value)) return show();
      if (end) remember();
      now[list][index] = Math.min(high, Math.max(low, value));
      show();
      solve();
    };
    let held = false;
    range.addEventListener("input", () => {
      if (!held) remember();
      held = true;
      put(Number(range.value), false);
    });
    range.addEventListener("change", () => {
      held = false;
    });
    range.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10 };
      if (!(event.key in steps)) return;
      event.preventDefault();
      put(now[list][index] + steps[event.key] * step, true);
    });
    box.addEventListener("change", () => put(Number(box.value), true));
    const show = () => {
      range.value = now[list][index];
      box.value = Number(now[list][index].toPrecision(4));
    };
    const made = h("div", { class: "slider" }, h("label", { for: id }, name), h("div", {}, range, box, h("span", { class: "unit" }, unit)));
    made.show = show;
    show();
    return made;
  };
  const variables = data.variables.map((v, i) => slider(v, "values", i));
  const loads = data.loads.map((l, i) => slider(l, "loads", i));
  const showSliders = () => [...variables, ...loads].forEach((each) => each.show());

  // Undo.
  const remember = () => {
    past.push(copy(now));
    if (past.length > 200) past.shift();
    future = [];
    buttons();
  };
  const go = (state) => {
    now = copy(state);
    showSliders();
    buttons();
    solve();
  };
  const undo = () => {
    if (!past.length) return;
    future.push(copy(now));
    go(past.pop());
  };
  const redo = () => {
    if (!future.length) return;
    past.push(copy(now));
    go(future.pop());
  };
  const reset = () => {
    remember();
    go(initial);
  };
  const undoButton = h("button", { type: "button", id: "undo", onclick: undo, title: "Ctrl+Z" }, "↶ Undo");
  const redoButton = h("button", { type: "button", id: "redo", onclick: redo, title: "Ctrl+Shift+Z" }, "↷ Redo");
  const buttons = () => {
    undoButton.disabled = !past.length;
    redoButton.disabled = !future.length;
  };
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    (event.shiftKey ? redo : undo)();
  });

  // The view and the report of the design, and of the kept one beside it.
  const host = h("div", { class: "host" });
  const legend = h("div", { class: "legends" });
  const names = h("div", { class: "names", "aria-hidden": "true" });
  const view = new Flexor.View(host, `${data.title} in three dimensions: drag or use the arrow keys to turn, + and - to zoom`);
  view.arrays = arrays;
  const controls = Flexor.viewControls(view, legend, () => design);
  let report = null;
  const stepper = Flexor.stepper((step) => {
    view.setStep(step);
    if (report) report.mark(step);
  });
  const charts = h("section", { "aria-label": "plots" });
  const table = h("section", { class: "scroll", "aria-label": "observables", tabindex: "0" });
  const verdicts = h("section", { "aria-label": "verdict" });
  const beside = h("input", { type: "checkbox", id: "compare", onchange: () => draw(true) });
  let columns = 0;

  const draw = (again = false) => {
    if (!design) return;
    const shown = beside.checked && kept ? [design, kept.design] : [design];
    view.show(shown, arrays, columns === shown.length && !again);
    columns = shown.length;
    names.replaceChildren(...(columns > 1 ? [h("span", {}, "this design"), h("span", {}, "kept design")] : []));
    report = Flexor.report(shown);
    charts.replaceChildren(report.charts);
    table.replaceChildren(h("h2", {}, "Observables"), report.table);
    verdicts.replaceChildren(
      h("h2", {}, "Verdict"),
      h("p", { id: "aim" }, data.aim ? `${data.aim}: ${design.aim}` : ""),
      Flexor.verdict(design),
      ...(columns > 1 ? [h("h3", {}, `kept design${kept.design.aim ? `: ${kept.design.aim}` : ""}`), Flexor.verdict(kept.design)] : []),
    );
    stepper.labels(design.labels, true);
    controls.refresh();
    mark();
  };

  // Solve for the latest design; while one request runs, further moves wait and only the last counts.
  let running = false, waiting = false;
  const solve = async () => {
    waiting = true;
    document.body.dataset.busy = "true";
    if (running) return;
    running = true;
    while (waiting) {
      waiting = false;
      const asked = copy(now);
      const began = performance.now();
      try {
        const answer = await (await ask("solve", { ...asked, known: [...arrays.keys()] })).json();
        await Flexor.decode(answer.blobs, arrays);
        design = { ...answer.design, title: "this design", state: asked };
        keepButton.disabled = false;
        draw();
        forget();
        say();
        const [solved, drawn] = answer.design.seconds.map((s) => (1000 * s).toFixed(1));
        const all = (performance.now() - began).toFixed(0);
        status.textContent = `solved in ${solved} ms, meshes in ${drawn} ms, shown after ${all} ms`;
        status.dataset.total = all;
        status.dataset.solved = solved;
      } catch (error) {
        say(error.message);
      }
    }
    running = false;
    document.body.dataset.ready = "true";
    delete document.body.dataset.busy;
  };
  // Drop arrays of designs that are no longer shown.
  const forget = () => {
    if (arrays.size < 400) return;
    const used = JSON.stringify([design, kept]);
    for (const key of [...arrays.keys()]) if (!used.includes(key)) arrays.delete(key);
  };

  // Compare.
  const keep = () => {
    kept = { design: { ...design, title: "kept design" }, state: copy(now) };
    beside.disabled = false;
    beside.checked = true;
    back.disabled = false;
    draw(true);
  };
  const keepButton = h("button", { type: "button", id: "keep", disabled: true, onclick: keep }, "Keep this design");
  const back = h("button", { type: "button", id: "restore", disabled: true, onclick: () => {
    const other = copy(kept.state);
    remember();
    go(other);
  } }, "Return to it");
  beside.disabled = true;

  // Save.
  const offer = (blob, ending) => {
    const link = h("a", { href: URL.createObjectURL(blob), download: `${data.name}${ending}` });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    document.body.dataset.saved = `${ending} ${blob.size}`;
  };
  const save = (name, ending, more = {}) => async () => {
    try {
      offer(await (await ask(name, { ...now, ...more })).blob(), ending);
      say();
    } catch (error) {
      say(error.message);
    }
  };
  const savePage = () => {
    const designs = [{ title: "design", ...now }];
    if (kept && beside.checked) designs.push({ title: "kept design", ...kept.state });
    return save("share", ".html", { designs })();
  };
  const tools = [
    ["model", "Model file", save("model", ".toml")],
    ["png", "Picture", async () => offer(await view.png(), ".png")],
    ["json", "Results (JSON)", save("json", ".json")],
    ["stl", "Rods (STL)", () => save("stl", ".stl", { step: stepper.step() })()],
    ["share", "Page to share", savePage],
  ].map(([id, text, act]) => h("button", { type: "button", id: `save-${id}`, onclick: act }, text));

  // Landscape over two variables.
  const options = () => data.variables.map((v, i) => h("option", { value: i }, v.name));
  const across = h("select", { id: "across" }, ...options());
  const up = h("select", { id: "up" }, ...options());
  if (data.variables.length > 1) up.value = "1";
  const points = h("input", { type: "number", id: "points", min: 2, max: 101, value: 21 });
  const map = h("canvas", { width: 300, height: 260, id: "map", tabindex: "0", role: "img", "aria-label": "landscape" });
  const said = h("p", { class: "soft", id: "landscape-status" });
  let field = null, mapping = null;
  const frame = { left: 44, right: 58, top: 8, bottom: 34 };
  const shade = (share) => {
    // Viridis at five points.
    const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
    const at = Math.min(3.999, Math.max(0, 4 * share)), k = Math.floor(at), t = at - k;
    return stops[k].map((c, i) => Math.round((1 - t) * c + t * stops[k + 1][i]));
  };
  const mark = () => {
    const context = map.getContext("2d");
    const style = getComputedStyle(document.body);
    map.hidden = !field;
    if (!field) return;
    context.clearRect(0, 0, map.width, map.height);
    const { x, y, rows, count } = field;
    const w = map.width - frame.left - frame.right, t = map.height - frame.top - frame.bottom;
    const all = rows.filter(Boolean).flatMap((row) => row.shown).filter((v) => v !== null);
    const [low, high] = [Math.min(...all), Math.max(...all)];
    rows.forEach((row, j) => {
      if (!row) return;
      row.shown.forEach((value, i) => {
        const left = frame.left + (i * w) / count, top = frame.top + ((count - 1 - j) * t) / count;
        const colour = value === null ? [128, 128, 128] : shade((value - low) / (high - low || 1));
        context.fillStyle = `rgb(${colour.join()})`;
        context.fillRect(left, top, w / count + 0.6, t / count + 0.6);
        if (value === null || row.broken[i]) {
          const light = value === null || colour[1] > 150;
          context.strokeStyle = light ? "rgba(0,0,0,0.75)" : "rgba(255,255,255,0.75)";
          context.beginPath();
          context.moveTo(left, top + t / count);
          context.lineTo(left + w / count, top);
          context.stroke();
        }
      });
    });
    context.fillStyle = style.color;
    context.font = "11px system-ui, sans-serif";
    const [vx, vy] = [data.variables[x], data.variables[y]];
    context.textAlign = "center";
    context.fillText(number(vx.low, 3), frame.left, map.height - 20);
    context.fillText(number(vx.high, 3), frame.left + w, map.height - 20);
    context.fillText(`${vx.name}${vx.unit ? ` / ${vx.unit}` : ""}`, frame.left + w / 2, map.height - 6);
    context.textAlign = "right";
    context.fillText(number(vy.low, 3), frame.left - 4, frame.top + t);
    context.fillText(number(vy.high, 3), frame.left - 4, frame.top + 10);
    context.save();
    context.translate(12, frame.top + t / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(`${vy.name}${vy.unit ? ` / ${vy.unit}` : ""}`, 0, 0);
    context.restore();
    for (let k = 0; k < t; k++) {
      context.fillStyle = `rgb(${shade(1 - k / t).join()})`;
      context.fillRect(frame.left + w + 8, frame.top + k, 10, 1.5);
    }
    context.fillStyle = style.color;
    context.textAlign = "left";
    context.fillText(number(high, 3), frame.left + w + 21, frame.top + 10);
    context.fillText(number(low, 3), frame.left + w + 21, frame.top + t);
    const spot = (values, colour) => {
      // Grid points are in the middle of their cells.
      const place = (v, i) => ((values[i] - v.low) / (v.high - v.low)) * (1 - 1 / count) + 0.5 / count;
      context.beginPath();
      context.arc(frame.left + w * place(vx, x), frame.top + t * (1 - place(vy, y)), 5, 0, 2 * Math.PI);
      context.fillStyle = colour;
      context.fill();
      context.lineWidth = 2;
      context.strokeStyle = "#fff";
      context.stroke();
      context.lineWidth = 1;
    };
    if (kept) spot(kept.state.values, "#cc79a7");
    spot(now.values, "#d55e00");
  };
  const mapButton = h("button", { type: "button", id: "landscape" }, "Evaluate");
  mapButton.addEventListener("click", async () => {
    if (mapping) return mapping.abort();
    const [x, y, count] = [Number(across.value), Number(up.value), Number(points.value)];
    mapping = new AbortController();
    mapButton.textContent = "■ Stop";
    field = { x, y, count, rows: Array(count).fill(null) };
    let done = 0;
    try {
      for await (const row of lines("landscape", { ...now, axes: [x, y], points: count }, mapping.signal)) {
        field.rows[row.row] = row;
        done += 1;
        said.textContent = `${data.quantity}: ${done * count} of ${count * count} designs; hatched: constraints are exceeded, grey: no result`;
        if (done % 2 === 0 || done === count) mark();
      }
      say();
    } catch (error) {
      if (error.name === "AbortError") said.textContent += "; stopped";
      else {
        field = null;
        said.textContent = "";
        say(error.message);
      }
    }
    mapping = null;
    mapButton.textContent = "Evaluate";
    mark();
  });
  map.addEventListener("click", (event) => {
    if (!field) return;
    const box = map.getBoundingClientRect();
    const w = map.width - frame.left - frame.right, t = map.height - frame.top - frame.bottom;
    const i = Math.floor((((event.clientX - box.left) * map.width) / box.width - frame.left) / (w / field.count));
    const j = field.count - 1 - Math.floor((((event.clientY - box.top) * map.height) / box.height - frame.top) / (t / field.count));
    if (i < 0 || j < 0 || i >= field.count || j >= field.count) return;
    remember();
    const to = copy(now);
    const value = (v, k) => v.low + (k / (field.count - 1)) * (v.high - v.low);
    to.values[field.x] = value(data.variables[field.x], i);
    to.values[field.y] = value(data.variables[field.y], j);
    go(to);
  });

  // Search.
  const method = h("select", { id: "method" }, ...data.methods.filter((m) => m !== "grid").map((m) => h("option", { value: m }, m)));
  if (data.methods.includes("auto")) method.value = "auto";
  const budget = h("input", { type: "number", id: "budget", min: 1, value: 500 });
  const seed = h("input", { type: "number", id: "seed", min: 0, value: 0 });
  const follow = h("input", { type: "checkbox", id: "follow", checked: true });
  const progress = h("p", { id: "search-status", class: "soft", role: "status" });
  const history = h("div", { id: "history" });
  let searching = null;
  const searchButton = h("button", { type: "button", id: "search" }, "Run");
  const plotHistory = (rows) => {
    if (rows.length < 2) return;
    const fake = {
      title: "search",
      loads: { label: "designs evaluated", unit: "", values: rows.map((r) => r.evaluations) },
      events: [],
      plots: [{ title: `Best ${data.quantity}`, unit: "", bounds: [], series: [{ name: "best so far", values: rows.map((r) => r.shown) }] }],
    };
    const chart = Flexor.chart(0, [fake]);
    chart.mark(rows.length - 1);
    history.replaceChildren(chart);
  };
  searchButton.addEventListener("click", async () => {
    if (searching) return searching.abort();
    searching = new AbortController();
    searchButton.textContent = "■ Stop";
    const rows = [];
    let best = null, before = "";
    const asked = { ...copy(now), method: method.value, budget: Number(budget.value), seed: Number(seed.value) };
    remember();
    progress.textContent = "starting";
    try {
      for await (const row of lines("optimise", asked, searching.signal)) {
        if (row.evaluations === undefined) continue;
        if (row.shown !== null) {
          rows.push(row);
          best = row;
        }
        const value = row.shown === null ? "no design so far" : `best ${number(row.shown)}${row.feasible ? "" : ", NOT FEASIBLE"}`;
        const rate = row.rate ? `, ${row.rate.toFixed(0)} designs/s` : "";
        progress.textContent = `${row.evaluations} designs${rate}: ${value}${row.ended ? `; ended: ${row.ended}` : ""}`;
        plotHistory(rows);
        if (follow.checked && best && JSON.stringify(best.values) !== before) {
          before = JSON.stringify(best.values);
          go({ values: best.values, loads: now.loads });
        }
      }
      say();
    } catch (error) {
      if (error.name === "AbortError") progress.textContent += "; stopped";
      else {
        progress.textContent = "";
        say(error.message);
      }
    }
    searching = null;
    searchButton.textContent = "Run";
    if (best) go({ values: best.values, loads: now.loads });
  });

  // The page.
  const panel = (title, open, ...children) => h("details", { open }, h("summary", {}, title), ...children);
  const varied = data.variables.length > 0;
  page.append(
    h("header", {}, h("h1", {}, data.title), h("p", {}, data.name)),
    h(
      "div",
      { class: "columns three" },
      h(
        "div",
        { class: "controls" },
        h("div", { class: "tools" }, undoButton, redoButton, h("button", { type: "button", id: "reset", onclick: reset }, "Reset")),
        message,
        panel("Loads", true, ...loads),
        panel("Dimensions", true, ...(varied ? variables : [h("p", {}, "Nothing varies: state [design] in the model file, or give --vary.")])),
        panel("Compare", true, h("div", { class: "tools" }, keepButton, h("label", {}, beside, " Side by side"), back)),
        varied ? panel("Search", true, h("div", { class: "tools" }, h("label", {}, "Method ", method), h("label", {}, "Designs ", budget), h("label", {}, "Seed ", seed), h("label", {}, follow, " Follow"), searchButton), progress, history) : null,
        data.variables.length > 1 ? panel("Landscape", true, h("div", { class: "tools" }, h("label", {}, "Across ", across), h("label", {}, "Up ", up), h("label", {}, "Points ", points), mapButton), said, map) : null,
        panel("Save", true, h("div", { class: "tools" }, ...tools)),
        status,
      ),
      h("div", { class: "stage" }, controls, h("div", { class: "frame" }, host, names, legend), stepper, charts),
      h("div", { class: "side" }, verdicts, table, h("section", { "aria-label": "provenance" }, h("h2", {}, "Provenance"), Flexor.provenance(data.provenance))),
    ),
  );
  buttons();
  solve();
})();
