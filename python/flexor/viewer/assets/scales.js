"use strict";
// Colours: of parts without a field, and of the values of a field.

Flexor.colours = {
  rod: ["#e69f00", "#6b4f1d", "#b5651d", "#c9b18a"],
  link: "#d5dbe1",
  skin: "#e3bfa6",
  bone: "#f3ede2",
  chamber: "#56b4e9",
  line: "#d55e00",
  strap: "#cc79a7",
  spring: "#009e73",
  tie: "#cc79a7",
  tendon: "#b2182b",
  wrap: "#9ecae1",
  obstacle: "#8f979e",
  holds: "#009e73",
  slides: "#d55e00",
};
// Series of plots (Okabe and Ito); the page's style has darker and lighter ones of the same hue.
Flexor.series = 7;

Flexor.linear = (channel) => {
  const c = channel / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
};

// The legend of a field: a bar with its ends and middle.
Flexor.legend = (scale, table) => {
  const { h, number } = Flexor;
  const bar = h("canvas", { width: table.length / 3, height: 1, class: "bar", role: "presentation" });
  const context = bar.getContext("2d");
  const image = context.createImageData(table.length / 3, 1);
  for (let i = 0; i < table.length / 3; i++) {
    image.data.set([table[3 * i], table[3 * i + 1], table[3 * i + 2], 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
  const middle = 0.5 * (scale.low + scale.high);
  return h(
    "figure",
    { class: "legend" },
    h("figcaption", {}, `${scale.label} / ${scale.unit}`),
    bar,
    h(
      "div",
      { class: "ticks" },
      ...[scale.low, middle, scale.high].map((v) => h("span", {}, number(v, 3))),
    ),
  );
};

// What the marks of points with friction mean, or null if a design has none.
Flexor.frictionKey = (design) => {
  const { h } = Flexor;
  if (!design.scene.objects.some((object) => object.kind === "friction")) return null;
  return h(
    "ul",
    { class: "legend marks" },
    h("li", {}, h("span", { class: "holds", "aria-hidden": "true" }, "◆"), " friction holds"),
    h("li", {}, h("span", { class: "slides", "aria-hidden": "true" }, "▶"), " slides: force on the first body"),
  );
};
