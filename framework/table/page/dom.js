'use strict';
/* What the scripts of all pages begin with: elements, and figures that were not measured. */
const $ = id => document.getElementById(id);
const isNumber = Number.isFinite;
const dash = '-'; // as figure.js and the terminal have it

/* An element; attributes that are false, null or undefined are left out, and so are such children. Text is never markup. */
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {}))
    if ((value ?? false) !== false) node.setAttribute(name, value === true ? '' : value);
  node.append(...children.filter(child => (child ?? null) !== null));
  return node;
}
