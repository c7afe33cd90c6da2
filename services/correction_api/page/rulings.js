// What people decide about versions: put one in force that was held back, or go back to another.
import { newId, post } from "./api.js";
import { html } from "./html.js";
import { Aloud } from "./line.js";
import { person, when } from "./shell.js";

const form = { notice: "", wrong: false, busy: false, id: newId() };

export function Decide({ policy, done }) {
  const fit = policy.rounds.filter(({ promotable }) => promotable);
  // While some robots run a later version first, to go back to the one in force ends that.
  const trial = policy.versions.at(-1)?.robots.length > 0 && policy.versions.at(-1);
  const back = policy.versions.filter(({ in_force: now }) => !now || trial).reverse();
  const after = ({ again, in_force: now }) => {
    if (now) return `, in force: ends the trial of ${trial.version}`;
    return again === null ? "" : `, ${named(again, policy.versions)} again`;
  };
  return html`
    <section class="panel wide" aria-label="Decide about versions">
      <h2>Decide</h2>
      <p class="lead">
        ${policy.version} is in force. What you decide is kept with your name and your reason; the
        learner does it at its next look, and robots take it up between two episodes.
      </p>
      <${Form}
        verb="rollback"
        versions=${policy.versions}
        label="Go back to version"
        act="Roll back"
        none="there is no earlier version"
        options=${back.map((one) => [one.number, `${one.version}${after(one)}`])}
        done=${done}
      />
      <${Form}
        verb="promote"
        versions=${policy.versions}
        label="Put out what the gate held back: round"
        act="Promote"
        none="the gate held nothing back"
        options=${fit.map(({ number }) => [number, `${number}`])}
        done=${done}
      />
      <${Aloud} class=${form.wrong ? "notice" : "small"}>${form.notice}<//>
    </section>
  `;
}

function Form({ verb, versions, label, act, none, options, done }) {
  const field = verb === "rollback" ? "version" : "round";
  const submit = async (event) => {
    event.preventDefault();
    const { elements } = event.target;
    const body = { verb, [field]: Number(elements[field].value), reason: elements.reason.value };
    if (form.busy) return;
    form.busy = true;
    const kept = await decide(body, versions);
    form.busy = false;
    if (kept) elements.reason.value = "";
    await done();
  };
  return html`
    <form class="decide" aria-label=${act} onSubmit=${submit}>
      <label class="field">
        ${label}
        <select name=${field} disabled=${!options.length}>
          ${options.length
            ? options.map(([number, text]) => html`<option value=${number}>${text}</option>`)
            : html`<option>${none}</option>`}
        </select>
      </label>
      <label class="field reason">
        reason
        <input name="reason" required maxlength="200" autocomplete="off" disabled=${!options.length} />
      </label>
      <button disabled=${!options.length}>${act}</button>
    </form>
  `;
}

/** True when it was kept; the same id until then, so that nothing is decided twice. */
async function decide(body, versions) {
  try {
    const kept = await post("policy/rulings", { ...body, author: person.id, id: form.id });
    Object.assign(form, { notice: `Kept: ${words(kept.ruling, versions)}.`, wrong: false, id: newId() });
    return true;
  } catch (problem) {
    Object.assign(form, { notice: problem.message, wrong: true });
    return false;
  }
}

const words = ({ verb, round, version }, versions) =>
  verb === "promote" ? `promote round ${round}` : `roll back to version ${named(version, versions)}`;

/** A version as people know it, such as 1.4. */
const named = (number, versions) =>
  versions.find((one) => one.number === number)?.version ?? `number ${number}`;

const STATES = {
  waiting: "on its way to the learner",
  given: "the learner has it",
  done: "done",
  refused: "refused",
};

export function Rulings({ rulings, versions }) {
  if (!rulings.length) return null;
  return html`
    <section class="panel wide" aria-label="What was decided">
      <div class="scroll" tabindex="0" role="region" aria-label="Table of decisions">
        <table>
          <caption>What was decided, the newest first</caption>
          <thead>
            <tr>
              <th scope="col">when</th>
              <th scope="col">by</th>
              <th scope="col">what</th>
              <th scope="col">reason</th>
              <th scope="col">state</th>
            </tr>
          </thead>
          <tbody>
            ${[...rulings].reverse().map(
              ({ ruling, state, made, why }) => html`
                <tr key=${ruling.id} data-ruling=${ruling.id}>
                  <td>${when(ruling.created_ns)}</td>
                  <td>${ruling.author}</td>
                  <td>${words(ruling, versions)}</td>
                  <td class="words">${ruling.reason}</td>
                  <td>
                    <span class=${`outcome ${state}`} data-mark=${state === "done" ? "✓" : state === "refused" ? "✗" : "…"}>
                      ${STATES[state]}
                    </span>
                    ${made !== null && `: version ${named(made, versions)} is made of it`}${why && `: ${why}`}
                  </td>
                </tr>
              `,
            )}
          </tbody>
        </table>
      </div>
    </section>
  `;
}
