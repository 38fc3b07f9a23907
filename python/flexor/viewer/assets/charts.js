"use strict";
// Plots along the load, as SVG.

Flexor.ticks = (low, high, most) => {
  const span = high - low || 1;
  const raw = span / most;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((s) => s >= raw * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * span; k++) {
    found.push(Number((k * step).toPrecision(12)));
  }
  return found;
};

// Draw a plot of one or two designs; returns an element with a method `mark(step)`.
Flexor.chart = (index, designs) => {
  const { h, number, ticks } = Flexor;
  const first = designs[0].plots[index];
  const width = 330, height = 168, left = 46, right = 10, top = 8, bottom = 34;
  const plots = designs.map((design) => ({
    design,
    plot: design.plots.find((plot) => plot.title === first.title),
  })).filter(({ plot }) => plot);
  const xs = plots.flatMap(({ design }) => design.loads.values);
  const bounds = first.bounds;
  const ys = plots.flatMap(({ plot }) => plot.series.flatMap((s) => s.values)).filter((v) => v !== null);
  const spread = [Math.min(0, ...ys), Math.max(0, ...ys)];
  if (spread[0] === spread[1]) spread[1] = 1;
  // A bound that is far beyond the curve would flatten it.
  for (const { value } of bounds) if (value <= 3 * spread[1]) spread[1] = Math.max(spread[1], 1.05 * value);
  const [x0, x1] = [Math.min(...xs), Math.max(...xs)];
  const [y0, y1] = spread;
  const px = (x) => left + ((x - x0) / (x1 - x0 || 1)) * (width - left - right);
  const py = (y) => height - bottom - ((y - y0) / (y1 - y0 || 1)) * (height - top - bottom);
  const svg = h("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${first.title} along the load` });
  for (const tick of ticks(y0, y1, 5)) {
    svg.append(
      h("line", { x1: left, x2: width - right, y1: py(tick), y2: py(tick), class: "grid" }),
      h("text", { x: left - 5, y: py(tick) + 3, "text-anchor": "end" }, number(tick)),
    );
  }
  for (const tick of ticks(x0, x1, 6)) {
    svg.append(h("text", { x: px(tick), y: height - bottom + 14, "text-anchor": "middle" }, number(tick)));
  }
  const { label, unit } = designs[0].loads;
  svg.append(
    h("text", { x: 0.5 * (left + width - right), y: height - 5, "text-anchor": "middle" }, unit ? `${label} / ${unit}` : label),
    h("line", { x1: left, x2: left, y1: top, y2: height - bottom, class: "axis" }),
    h("line", { x1: left, x2: width - right, y1: py(0), y2: py(0), class: "axis" }),
  );
  for (const { text, value } of bounds) {
    if (value > y1 || value < y0) continue;
    svg.append(
      h("line", { x1: left, x2: width - right, y1: py(value), y2: py(value), class: "bound" }),
      h("text", { x: width - right, y: py(value) - 3, "text-anchor": "end", class: "boundtext" }, text),
    );
  }
  plots.forEach(({ design, plot }, which) => {
    for (const event of design.events) {
      svg.append(
        h("line", { x1: px(event.at), x2: px(event.at), y1: top, y2: height - bottom, class: "event" }, h("title", {}, event.text)),
        h("text", { x: px(event.at) + 3, y: top + 9, class: "eventtext" }, event.kind),
      );
    }
    plot.series.forEach(({ name, values }, i) => {
      let path = "", pen = "M";
      values.forEach((v, k) => {
        if (v === null) {
          pen = "M";
          return;
        }
        path += `${pen}${px(design.loads.values[k]).toFixed(2)} ${py(v).toFixed(2)}`;
        pen = "L";
      });
      svg.append(h("path", { d: path, class: `series s${i % Flexor.series}${which ? " second" : ""}` }, h("title", {}, name)));
      values.forEach((v, k) => {
        if (v !== null && values.length <= 40 && !which) {
          svg.append(h("circle", { cx: px(design.loads.values[k]), cy: py(v), r: 1.8, class: `dot s${i % Flexor.series}` }));
        }
      });
    });
  });
  const cursor = h("line", { y1: top, y2: height - bottom, class: "cursor" });
  svg.append(cursor);
  const values = first.series.map(() => h("span", { class: "value" }));
  const keys = first.series.map(({ name }, i) =>
    h("li", {}, h("span", { class: `swatch s${i % Flexor.series}`, "aria-hidden": "true" }), name, " ", values[i]),
  );
  const made = h(
    "figure",
    { class: "chart" },
    h("figcaption", {}, first.unit ? `${first.title} / ${first.unit}` : first.title),
    svg,
    h("ul", { class: "keys" }, ...keys),
  );
  made.mark = (step) => {
    const at = Math.min(step, designs[0].loads.values.length - 1);
    const x = px(designs[0].loads.values[at]);
    cursor.setAttribute("x1", x);
    cursor.setAttribute("x2", x);
    first.series.forEach((series, i) => {
      values[i].textContent = number(series.values[at]);
    });
  };
  return made;
};
