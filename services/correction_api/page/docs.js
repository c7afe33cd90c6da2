// The OpenAPI text, for people: routes, what they take, and an example of each answer.
import { get } from "./api.js";
import { html, render } from "./html.js";

const json = (value) => JSON.stringify(value, null, 2);

function Docs({ text }) {
  const routes = Object.entries(text.paths).flatMap(([path, methods]) =>
    Object.entries(methods).map(([method, route]) => ({ path, method, route })),
  );
  return html`
    <main class="docs">
      <h1>${text.info.title}</h1>
      <p class="about">${text.info.description}</p>
      ${routes.map((entry) => html`<${Route} ...${entry} schemas=${text.components.schemas} />`)}
      <p>For programs: <a href="api/v1/openapi.json">openapi.json</a></p>
    </main>
  `;
}

function Route({ path, method, route, schemas }) {
  const asked = route.requestBody?.content["application/json"].schema.$ref;
  const body = asked && schemas[asked.split("/").pop()];
  return html`
    <details class="route">
      <summary>
        <span class=${`method ${method}`}>${method.toUpperCase()}</span>
        <code>${path}</code>
        <p>${route.summary}</p>
      </summary>
      <div class="body">
        ${(route.parameters ?? []).map(
          ({ name, in: place, description }) => html`
            <p><code>${name}</code> in the ${place}${description && `: ${description}`}</p>
          `,
        )}
        ${body && html`<p class="says">${body.description}</p>`}
        ${(body?.examples ?? []).map((example) => html`<pre>${json(example)}</pre>`)}
        ${Object.entries(route.responses).map(([status, answer]) => Answer(status, answer))}
      </div>
    </details>
  `;
}

function Answer(status, { description, content = {} }) {
  const [media] = Object.values(content);
  const example = media?.example;
  return html`
    <p><b>${status}</b> ${description}</p>
    ${example && html`<pre>${typeof example === "string" ? example : json(example)}</pre>`}
  `;
}

render(html`<${Docs} text=${await get("openapi.json")} />`, document.body);
