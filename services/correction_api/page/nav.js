// The way between the pages; each of them shows it in its head: <Nav here="episodes.html" />.
import { html } from "./html.js";

const PAGES = [
  ["./", "Live"],
  ["episodes.html", "Episodes"],
  ["progress.html", "Progress"],
  ["figures.html", "Figures"],
  ["docs.html", "API"],
];

export function Nav({ here }) {
  return html`
    <nav class="pages" aria-label="Pages">
      ${PAGES.map(
        ([path, name]) => html`
          <a key=${path} href=${path} aria-current=${path === here ? "page" : null}>${name}</a>
        `,
      )}
    </nav>
  `;
}
