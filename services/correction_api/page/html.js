// The two libraries, joined: `html` turns a template into Preact elements.
import htm from "./vendor/htm.js";
import { h } from "./vendor/preact.js";

export { Component, render } from "./vendor/preact.js";
export const html = htm.bind(h);
