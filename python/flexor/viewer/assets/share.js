"use strict";
// The page of `flexor share`.

(async () => {
  const { h } = Flexor;
  const data = JSON.parse(document.getElementById("data").textContent);
  const arrays = await Flexor.decode(data.blobs, new Map());
  const page = document.getElementById("page");
  const host = h("div", { class: "host" });
  const legend = h("div", { class: "legends" });
  const names = h("div", { class: "names", "aria-hidden": "true" });
  let shown = [data.designs[0]];
  let report = null;
  const view = new Flexor.View(host, `${data.title} in three dimensions: drag or use the arrow keys to turn, + and - to zoom`);
  const controls = Flexor.viewControls(view, legend, () => shown[0]);
  const stepper = Flexor.stepper((step) => {
    view.setStep(step);
    if (report) report.mark(step);
  });
  const charts = h("section", { "aria-label": "plots" });
  const table = h("section", { class: "scroll", "aria-label": "observables", tabindex: "0" });
  const verdicts = h("section", { "aria-label": "verdict" });
  const parameters = h("section", { class: "scroll", "aria-label": "parameters", tabindex: "0" });
  const choose = data.designs.length > 1
    ? h(
        "select",
        { id: "designs", onchange: (event) => pick(event.target.value) },
        ...data.designs.map((d, i) => h("option", { value: String(i) }, d.title)),
        h("option", { value: "both" }, data.designs.map((d) => d.title).join(" | ")),
      )
    : null;
  if (choose) controls.prepend(h("label", {}, "Design ", choose));

  const pick = (which) => {
    const before = shown.length;
    shown = which === "both" ? data.designs : [data.designs[Number(which)]];
    view.show(shown, arrays, report !== null && shown.length === before);
    names.replaceChildren(...(shown.length > 1 ? shown.map((d) => h("span", {}, d.title)) : []));
    report = Flexor.report(shown);
    charts.replaceChildren(report.charts);
    table.replaceChildren(h("h2", {}, "Observables"), report.table);
    verdicts.replaceChildren(h("h2", {}, "Verdict"), ...shown.flatMap((d) => [shown.length > 1 ? h("h3", {}, d.title) : null, Flexor.verdict(d)].filter(Boolean)));
    const list = Flexor.parameters(data.designs);
    parameters.replaceChildren(...(list ? [h("h2", {}, "Design"), list] : []));
    stepper.labels(shown[0].labels, true);
    controls.refresh();
  };

  page.append(
    h("header", {}, h("h1", {}, data.title), h("p", {}, data.name)),
    h(
      "div",
      { class: "columns" },
      h("div", { class: "stage" }, controls, h("div", { class: "frame" }, host, names, legend), stepper, data.note ? h("p", { class: "warning" }, data.note) : null, charts),
      h("div", { class: "side" }, verdicts, Flexor.serves(data.serves), parameters, table, h("section", { "aria-label": "provenance" }, h("h2", {}, "Provenance"), Flexor.provenance(data.provenance))),
    ),
  );
  pick("0");
  document.body.dataset.ready = "true";
})();
