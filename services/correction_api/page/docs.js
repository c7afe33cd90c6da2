// The OpenAPI text, for people: routes, what they take, and an example of each answer.
import { get } from "./api.js";
import { html } from "./html.js";
import { every, Notice, page } from "./shell.js";

const state = { text: null, notice: "" };

const REFRESH_S = 5;

const touch = page("docs.html", view, async () => {
  await load();
  every(REFRESH_S, () => state.text || load());
});

async function load() {
  try {
    state.text = await get("openapi.json");
  } catch (error) {
    state.notice = error.message;
  }
  touch();
}

const json = (value) => JSON.stringify(value, null, 2);

/** What stands between backticks is code. */
const coded = (text) => text.split("`").map((part, at) => (at % 2 ? html`<code>${part}</code>` : part));

/** A single new line is none. */
const Prose = ({ text }) =>
  text.split(/\n\s*\n/).map((paragraph) => html`<p class="about">${coded(paragraph)}</p>`);

function view() {
  const { text, notice } = state;
  if (!text) return html`<main class="docs"><${Notice} text=${notice} /></main>`;
  const routes = Object.entries(text.paths).flatMap(([path, methods]) =>
    Object.entries(methods).map(([method, route]) => ({ path, method, route })),
  );
  return html`
    <main class="docs">
      <h2>${text.info.title}</h2>
      <${Prose} text=${text.info.description} />
      ${routes.map((entry) => html`<${Route} ...${entry} schemas=${text.components.schemas} />`)}
      <p>For programs: <a href="api/v1/openapi.json">openapi.json</a></p>
    </main>
  `;
}

function Route({ path, method, route, schemas }) {
  const asked = route.requestBody?.content["application/json"]?.schema.$ref;
  const body = asked && schemas[asked.split("/").pop()];
  return html`
    <details class="route">
      <summary>
        <span class=${`method ${method}`}>${method.toUpperCase()}</span>
        <code>${path}</code>
        <p>${coded(route.summary)}</p>
      </summary>
      <div class="body">
        ${(route.parameters ?? []).map(
          ({ name, in: place, description }) => html`
            <p><code>${name}</code> in the ${place}${description && html`: ${coded(description)}`}</p>
          `,
        )}
        ${asked ? "" : route.requestBody && html`<${Raw} ...${route.requestBody} />`}
        ${body && html`<p class="says">${coded(body.description)}</p>`}
        ${(body?.examples ?? []).map((example) => html`<pre>${json(example)}</pre>`)}
        ${Object.entries(route.responses).map(([status, answer]) => Answer(status, answer))}
      </div>
    </details>
  `;
}

/** A body that is no JSON. */
const Raw = ({ description, content }) =>
  html`<p class="says"><code>${Object.keys(content).join(", ")}</code>: ${description}</p>`;

function Answer(status, { description, content = {} }) {
  const [media] = Object.values(content);
  const example = media?.example;
  return html`
    <p><b>${status}</b> ${coded(description)}</p>
    ${example && html`<pre>${typeof example === "string" ? example : json(example)}</pre>`}
  `;
}
