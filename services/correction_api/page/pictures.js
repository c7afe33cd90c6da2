// Camera pictures, drawn past Preact: the newest wins, and one is decoded at a time per camera.
import { Component, html } from "./html.js";

const boards = new Map(); // by robot and camera: where its pictures are drawn

/** Draw a picture that came; one that nobody shows is forgotten. */
export function show(head, jpeg) {
  const board = boards.get(`${head.robot}/${head.camera}`);
  if (!board) return;
  board.next = { head, jpeg };
  if (!board.busy) draw(board);
}

/** The control step of the picture that a person sees now, and its episode; null: none is in view. */
export function seen(robot) {
  const board = boards.get(`${robot}/angle`);
  return board?.inView ? board.seen : null;
}

async function draw(board) {
  board.busy = true;
  while (board.next) {
    const { head, jpeg } = board.next;
    board.next = null;
    try {
      const image = await createImageBitmap(new Blob([jpeg], { type: "image/jpeg" }));
      for (const canvas of board.canvases) paint(canvas, image, head.step);
      image.close();
      board.seen = { step: head.step, episode: head.episode };
    } catch {
      continue; // A picture that is none: the next one will do.
    }
  }
  board.busy = false;
}

function paint(canvas, image, step) {
  if (canvas.width !== image.width || canvas.height !== image.height) {
    canvas.width = image.width;
    canvas.height = image.height;
  }
  canvas.getContext("2d").drawImage(image, 0, 0);
  canvas.dataset.step = step;
  canvas.dataset.drawn = Number(canvas.dataset.drawn ?? 0) + 1;
  canvas.classList.add("drawn");
}

/** One camera of one robot at a rate; pictures are asked for only while it can be seen. */
export class Picture extends Component {
  shouldComponentUpdate() {
    return false;
  }

  componentDidMount() {
    const { robot, camera, rate, turn } = this.props;
    this.board = boards.get(`${robot}/${camera}`) ?? {
      canvases: new Set(),
      seen: null,
      inView: 0,
    };
    boards.set(`${robot}/${camera}`, this.board);
    this.board.canvases.add(this.canvas);
    this.eye = new IntersectionObserver(([entry]) => {
      if (this.looking === entry.isIntersecting) return;
      this.looking = entry.isIntersecting;
      this.board.inView += this.looking ? 1 : -1;
      turn(robot, camera, rate, this.looking);
    });
    this.looking = false;
    this.eye.observe(this.canvas);
  }

  componentWillUnmount() {
    const { robot, camera, rate, turn } = this.props;
    this.eye.disconnect();
    this.board.canvases.delete(this.canvas);
    if (!this.board.canvases.size) boards.delete(`${robot}/${camera}`);
    if (!this.looking) return;
    this.board.inView -= 1;
    turn(robot, camera, rate, false);
  }

  render({ robot, camera }) {
    const keep = (canvas) => (this.canvas = canvas);
    const label = `${robot}, ${camera} camera`;
    return html`
      <canvas ref=${keep} class=${camera} width="320" height="240" role="img" aria-label=${label} />
    `;
  }
}
