// The WebSocket: states come as JSON texts, pictures as binary messages. It comes back by itself,
// until it is ended. Both sides say every second that they are there: a socket that hangs looks like
// one on which nothing happens.
import { get, socketUrl, token } from "./api.js";

const RETRY_MS = [300, 700, 1500, 3000];
const MOST_VIEWS = 128;
const BEAT_MS = 1000;
const QUIET_MS = 5000; // So long nothing may be heard.
const HANGS_MS = 10_000; // After this a new connection is tried.

export class Live {
  /** heard(message): a state; seen(head, jpeg): a picture; linked(yes): the connection;
   *  present(): what is told of who looks; quiet(seconds): how long nothing was heard, 0 if not
   *  for long. */
  constructor({ heard, seen, linked, present, quiet }) {
    Object.assign(this, { heard, seen, linked, present, quiet });
    this.views = new Map(); // by robot and camera: how many look at it, at each rate
    this.tries = 0;
    document.addEventListener("visibilitychange", () => {
      this.heardAt = performance.now(); // A page that was hidden may have slept.
      this.look();
    });
    this.heardAt = performance.now();
    this.beating = setInterval(() => this.beat(), BEAT_MS);
    this.connect();
  }

  connect() {
    this.beganAt = performance.now();
    const protocols = ["hld", ...(token.get() ? [`token.${token.get()}`] : [])];
    this.socket = new WebSocket(socketUrl(), protocols);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.tries = this.taken = this.shown = 0;
      this.linked(true);
      this.look();
    };
    this.socket.onmessage = ({ data }) => {
      this.heardAt = performance.now();
      if (typeof data === "string") this.heard(JSON.parse(data));
      else this.unpack(data);
      this.take();
    };
    this.socket.onclose = () => {
      this.linked(false);
      if (this.ended) return;
      if (this.tries) this.ask();
      const pause = RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)];
      this.coming = setTimeout(() => this.connect(), pause);
    };
  }

  /** A browser doesn't tell why a WebSocket was not let in; an answer to a question would (401). */
  ask() {
    get("me").catch(() => {});
  }

  /** Don't come back. */
  end() {
    this.ended = true;
    clearTimeout(this.coming);
    clearInterval(this.beating);
    this.socket.close();
  }

  /** Tell how much was taken in, once it is shown: a page that is busy gets less, and newer. */
  take() {
    this.taken += 1;
    if (this.telling) return;
    this.telling = true;
    requestAnimationFrame(() => {
      this.telling = false;
      this.shown = this.taken;
      this.send({ taken: this.shown });
    });
  }

  send(words) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(words));
  }

  /** Say that one is there, and see for how long nobody else was. */
  beat() {
    this.send({ taken: this.shown });
    if (document.hidden) return;
    const now = performance.now();
    const silent = now - this.heardAt;
    this.quiet(silent > QUIET_MS ? Math.floor(silent / 1000) : 0);
    if (silent > HANGS_MS && now - this.beganAt > HANGS_MS) this.renew();
  }

  /** Connect anew: a network that is gone never closes a socket. */
  renew() {
    clearTimeout(this.coming);
    Object.assign(this.socket, { onopen: null, onmessage: null, onclose: null });
    this.socket.close();
    this.linked(false);
    this.connect();
  }

  /** Look at a camera at a rate ("full" or "slow"), or no longer. */
  turn(robot, camera, rate, on) {
    const key = `${robot}/${camera}`;
    const view = this.views.get(key) ?? { robot, camera, full: 0, slow: 0 };
    view[rate] += on ? 1 : -1;
    this.views.set(key, view);
    clearTimeout(this.turning);
    this.turning = setTimeout(() => this.look(), 50);
  }

  look() {
    const wanted = document.hidden ? [] : [...this.views.values()].filter(someone);
    const watch = wanted.slice(0, MOST_VIEWS).map(({ robot, camera, full }) => ({
      robot,
      camera,
      rate: full ? "full" : "slow",
    }));
    this.send({ watch, ...this.present() });
  }

  unpack(buffer) {
    const size = new DataView(buffer).getUint16(0);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 2, size)));
    this.seen(head, new Uint8Array(buffer, 2 + size));
  }
}

const someone = ({ full, slow }) => full + slow > 0;
