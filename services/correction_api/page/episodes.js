// Episodes as a list: filtered by what they were like, and the filters kept in the address.
import { get } from "./api.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { every, Notice, page, when } from "./shell.js";
import { count } from "./words.js";

const YES_NO = { corrected: ["corrected", "not corrected"], doubt: ["in doubt", "never in doubt"] };
const MARKS = { success: "✓", timeout: "✗", aborted: "–" };
const REFRESH_S = 10;

const filters = new URLSearchParams(location.search);
const state = { episodes: [], tally: [], tasks: [], next: null, notice: "", loaded: false };

const touch = page("episodes.html", view, async () => {
  await load();
  every(REFRESH_S, () => state.episodes.length <= 50 && load());
});

async function load(cursor) {
  const query = new URLSearchParams(filters);
  if (cursor) query.set("cursor", cursor);
  try {
    const found = await get(`episodes?${query}`);
    const { tally, tasks, next } = found;
    const episodes = cursor ? [...state.episodes, ...found.episodes] : found.episodes;
    Object.assign(state, { episodes, tally, tasks, next, notice: "", loaded: true });
  } catch (problem) {
    state.notice = problem.message;
  }
  touch();
}

function choose(name, value) {
  if (value) filters.set(name, value);
  else filters.delete(name);
  history.replaceState(null, "", filters.size ? `?${filters}` : location.pathname);
  load();
}

function view() {
  const versions = state.tally.map(({ version }) => version).reverse();
  return html`
    <main class="after">
      <section class="panel" aria-label="Episodes">
        <form class="filters" onSubmit=${(event) => event.preventDefault()}>
          <${Choose} name="task" label="Task" all="all tasks" options=${pairs(state.tasks)} />
          <${Choose} name="version" label="Version" all="all versions" options=${pairs(versions)} />
          <${Choose}
            name="success"
            label="Success"
            all="any outcome"
            options=${[["true", "succeeded"], ["false", "did not"]]}
          />
          ${Object.entries(YES_NO).map(
            ([name, [yes, no]]) => html`
              <${Choose}
                name=${name}
                label=${yes[0].toUpperCase() + yes.slice(1)}
                all="either"
                options=${[["true", yes], ["false", no]]}
              />
            `,
          )}
          ${filters.size > 0 && html`<button type="button" onClick=${clear}>All episodes</button>`}
        </form>
        <${Notice} text=${state.notice} />
        <${Aloud} class=${state.episodes.length ? "small" : "lead"} quiet>${counted()}<//>
        ${state.episodes.length > 0 && html`<${List} />`}
      </section>
    </main>
  `;
}

const pairs = (names) => names.map((name) => [name, name]);

function clear() {
  for (const name of [...filters.keys()]) filters.delete(name);
  choose("task", "");
}

function Choose({ name, label, all, options }) {
  const value = filters.get(name) ?? "";
  return html`
    <label>
      ${label}
      <select name=${name} onChange=${(event) => choose(name, event.target.value)}>
        <option value="" selected=${!value}>${all}</option>
        ${options.map(
          ([key, text]) => html`<option value=${key} selected=${key === value}>${text}</option>`,
        )}
      </select>
    </label>
  `;
}

function List() {
  return html`
    <div class="scroll" tabindex="0" role="region" aria-label="List of episodes">
      <table class="list" role="table" aria-label="Episodes">
        <thead>
          <tr>
            <th scope="col">ended</th>
            <th scope="col">outcome</th>
            <th scope="col">task and prompt</th>
            <th scope="col">robot</th>
            <th scope="col">version</th>
            <th scope="col" class="number">seconds</th>
            <th scope="col" class="number">decisions</th>
            <th scope="col" class="number">taught</th>
            <th scope="col" class="number">in doubt</th>
          </tr>
        </thead>
        <tbody>
          ${state.episodes.map((episode) => html`<${Row} key=${episode.id} ...${episode} />`)}
        </tbody>
      </table>
    </div>
    ${state.next &&
    html`<p><button onClick=${() => load(state.next)}>Show earlier ones</button></p>`}
  `;
}

function counted() {
  const { episodes, next, loaded } = state;
  if (!loaded) return "";
  if (!episodes.length) return filters.size ? "No episode is like this." : "No episode has ended yet.";
  const number = next ? `${episodes.length} or more episodes` : count(episodes.length, "episode");
  return `${number}, the newest first`;
}

function Row(episode) {
  const taught = Math.max(episode.taught, episode.corrections);
  return html`
    <tr role="row" data-episode=${episode.id}>
      <th scope="row" role="rowheader"><a href=${`episode.html?id=${episode.id}`}>${when(episode.ended_ns)}</a></th>
      <td role="cell">
        <span class=${`outcome ${episode.outcome}`} data-mark=${MARKS[episode.outcome]}>
          ${episode.outcome}
        </span>
      </td>
      <td role="cell" class="words">${episode.prompt} <span class="chip">${episode.task}</span></td>
      <td role="cell" class="robot-name" data-label="">${episode.robot}</td>
      <td role="cell" data-label="version">${episode.version}</td>
      <td role="cell" class="number" data-label="seconds">${(episode.steps / 50).toFixed(1)}</td>
      <td role="cell" class="number" data-label="decisions">${episode.decisions}</td>
      <td role="cell" class="number" data-label="taught">${taught || "–"}</td>
      <td role="cell" class="number" data-label="in doubt">
        ${episode.calls ? html`<span class="chip warn">? ${episode.calls}</span>` : "–"}
      </td>
    </tr>
  `;
}
