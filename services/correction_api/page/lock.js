// What a page shows while the service wants a token that this browser doesn't have, or had once.
import { token } from "./api.js";
import { html } from "./html.js";

const WANTED = "Whoever steers robots here needs a token.";
const REFUSED =
  "The token of this page is not good here, or no longer: it was mistyped, or taken out of the " +
  "settings. Type another one; you get it from whoever keeps this service.";

export function Lock() {
  const unlock = (event) => {
    event.preventDefault();
    token.set(event.target.elements.token.value.trim());
    location.reload();
  };
  return html`
    <main class="lock">
      <h1>hl-dagger</h1>
      <p role="alert">${token.get() ? REFUSED : WANTED}</p>
      <form onSubmit=${unlock}>
        <label>Token of this service <input name="token" type="password" required /></label>
        <button>Open</button>
      </form>
    </main>
  `;
}
