// Camera pictures, drawn past Preact: the newest wins, and one is decoded at a time per camera.
import { Component, html } from "./html.js";

const boards = new Map();

/** Draw a picture that came; one that nobody shows is forgotten. */
export function show(head, jpeg) {
  const board = boards.get(`${head.robot}/${head.camera}`);
  if (!board) return;
  board.next = { head, jpeg };
  if (!board.busy) draw(board);
}

/** The control step of the picture that a person sees now. */
export const seenStep = (robot) => boards.get(`${robot}/angle`)?.step ?? null;

async function draw(board) {
  board.busy = true;
  while (board.next) {
    const { head, jpeg } = board.next;
    board.next = null;
    try {
      const image = await createImageBitmap(new Blob([jpeg], { type: "image/jpeg" }));
      paint(board, image, head);
    } catch {
      continue; // A picture that is none: the next one will do.
    }
  }
  board.busy = false;
}

function paint(board, image, head) {
  const { canvas } = board;
  if (canvas.width !== image.width || canvas.height !== image.height) {
    canvas.width = image.width;
    canvas.height = image.height;
  }
  canvas.getContext("2d").drawImage(image, 0, 0);
  image.close();
  board.step = head.step;
  canvas.dataset.step = head.step;
  canvas.classList.add("drawn");
}

/** One camera of one robot; pictures are asked for only while it can be seen. */
export class Picture extends Component {
  shouldComponentUpdate() {
    return false;
  }

  componentDidMount() {
    const { robot, camera, turn } = this.props;
    boards.set(`${robot}/${camera}`, { canvas: this.canvas, step: null, next: null, busy: false });
    this.eye = new IntersectionObserver(([entry]) => turn(robot, camera, entry.isIntersecting));
    this.eye.observe(this.canvas);
  }

  componentWillUnmount() {
    const { robot, camera, turn } = this.props;
    this.eye.disconnect();
    boards.delete(`${robot}/${camera}`);
    turn(robot, camera, false);
  }

  render({ robot, camera }) {
    const keep = (canvas) => (this.canvas = canvas);
    const label = `${robot}, ${camera} camera`;
    return html`
      <canvas ref=${keep} class=${camera} width="320" height="240" role="img" aria-label=${label} />
    `;
  }
}
