// The WebSocket: states come as JSON texts, pictures as binary messages. It comes back by itself.
import { socketUrl, token } from "./api.js";

const RETRY_MS = [300, 700, 1500, 3000];

export class Live {
  /** heard(message): a state; seen(head, jpeg): a picture; linked(yes): the connection. */
  constructor({ heard, seen, linked }) {
    Object.assign(this, { heard, seen, linked });
    this.views = new Map();
    this.tries = 0;
    document.addEventListener("visibilitychange", () => this.look());
    this.connect();
  }

  connect() {
    const protocols = ["hld", ...(token.get() ? [`token.${token.get()}`] : [])];
    this.socket = new WebSocket(socketUrl(), protocols);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.tries = 0;
      this.linked(true);
      this.look();
    };
    this.socket.onmessage = ({ data }) =>
      typeof data === "string" ? this.heard(JSON.parse(data)) : this.unpack(data);
    this.socket.onclose = () => {
      this.linked(false);
      const pause = RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)];
      setTimeout(() => this.connect(), pause);
    };
  }

  /** Look at a camera, or no longer. */
  turn(robot, camera, on) {
    const key = `${robot}/${camera}`;
    if (on) this.views.set(key, { robot, camera });
    else this.views.delete(key);
    clearTimeout(this.turning);
    this.turning = setTimeout(() => this.look(), 50);
  }

  look() {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    const watch = document.hidden ? [] : [...this.views.values()].slice(0, 128);
    this.socket.send(JSON.stringify({ watch }));
  }

  unpack(buffer) {
    const size = new DataView(buffer).getUint16(0);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 2, size)));
    this.seen(head, new Uint8Array(buffer, 2 + size));
  }
}
