"use strict";
// Shared by all pages: reading arrays and building elements. Texts become text nodes, never markup.
const Flexor = {};

Flexor.kinds = { f: Float32Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };

// Add the arrays of a table to a map from keys to typed arrays.
Flexor.decode = async (table, into) => {
  await Promise.all(
    Object.entries(table).map(async ([key, entry]) => {
      const binary = atob(entry.data);
      let bytes = new Uint8Array(binary.length);
      for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
      if (entry.zlib) {
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
        bytes = new Uint8Array(await new Response(stream).arrayBuffer());
      }
      into.set(key, new Flexor.kinds[entry.type](bytes.buffer, 0, entry.size));
    }),
  );
  return into;
};

// Make an element: attributes, listeners ("onclick") and children, which may be texts.
Flexor.h = (tag, properties = {}, ...children) => {
  const svg = ["svg", "g", "path", "line", "text", "circle", "rect", "title"].includes(tag);
  const made = svg
    ? document.createElementNS("http://www.w3.org/2000/svg", tag)
    : document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? "" : String(value));
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
};

// Format a number with a few significant digits.
Flexor.number = (value, digits = 4) =>
  value === null || value === undefined || !Number.isFinite(value)
    ? "–"
    : String(Number(value.toPrecision(digits))).replace("-", "−");
