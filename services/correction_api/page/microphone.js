// The microphone: opened when it is needed, let go when it has not been for a while.
const RATE_HZ = 16_000;
const KEEP_MS = 30_000;
const SOUND = { audio: { echoCancellation: false, noiseSuppression: false, autoGainControl: false } };

let open = null; // a promise of { context, stream, recorder }
let ended = () => {}; // what waits for the sound
let loud = () => {};
let leaving = null;

/** Why this page gets no microphone at all, and what to do; null where it may get one. */
export function barred() {
  if (navigator.mediaDevices?.getUserMedia && window.AudioWorkletNode) return null;
  const port = location.port || "8000";
  return (
    "The browser gives a microphone only to pages by https or from localhost. Serve this one with " +
    "tls_certificate and tls_key, or on your own machine run " +
    `ssh -L ${port}:localhost:${port} ${location.hostname} and open localhost:${port}.`
  );
}

/** Record from now on. level(share): how loud it is, 0 to 1. Rejects with a reason for people. */
export async function begin(level) {
  clearTimeout(leaving);
  loud = level;
  try {
    if (open) (await open).recorder.port.postMessage("begin");
    else await (open = enter());
  } catch (error) {
    open = null;
    throw new Error(reason(error));
  }
}

/** Stop recording. Returns the sound as the server wants it, or null where nothing was recorded. */
export async function end() {
  clearTimeout(leaving);
  leaving = setTimeout(leave, KEEP_MS);
  const { context, recorder } = await open;
  const blocks = await new Promise((resolve) => {
    ended = resolve;
    recorder.port.postMessage("end");
  });
  return blocks.length ? resample(blocks, context.sampleRate) : null;
}

/** The microphone comes last, when everything is ready to record it. */
async function enter() {
  const context = new AudioContext();
  await context.audioWorklet.addModule(new URL("recorder.js", import.meta.url));
  const recorder = new AudioWorkletNode(context, "recorder", {
    channelCount: 1,
    channelCountMode: "explicit",
  });
  recorder.port.onmessage = ({ data }) =>
    typeof data === "number" ? loud(Math.min(1, 2 * data)) : ended(data);
  await context.resume();
  const stream = await navigator.mediaDevices.getUserMedia(SOUND).catch(async (error) => {
    await context.close();
    throw error;
  });
  context.createMediaStreamSource(stream).connect(recorder);
  return { context, stream, recorder };
}

/** Let the microphone go: the browser shows as long as it is held. */
async function leave() {
  const { context, stream } = await open;
  open = null;
  for (const track of stream.getTracks()) track.stop();
  await context.close();
}

/** [blocks] float32 at any rate -> int16 at RATE_HZ, little-endian. */
async function resample(taken, rate) {
  const length = taken.reduce((sum, block) => sum + block.length, 0);
  const offline = new OfflineAudioContext(1, Math.ceil((length * RATE_HZ) / rate), RATE_HZ);
  const buffer = offline.createBuffer(1, length, rate);
  let at = 0;
  for (const block of taken) {
    buffer.copyToChannel(block, 0, at);
    at += block.length;
  }
  const source = new AudioBufferSourceNode(offline, { buffer });
  source.connect(offline.destination);
  source.start();
  const samples = (await offline.startRendering()).getChannelData(0);
  const bytes = new DataView(new ArrayBuffer(2 * samples.length));
  samples.forEach((value, place) =>
    bytes.setInt16(2 * place, 32_767 * Math.max(-1, Math.min(1, value)), true),
  );
  return bytes.buffer;
}

function reason(error) {
  switch (error.name) {
    case "NotAllowedError":
      return "The microphone is not allowed for this page: allow it in the browser's address bar.";
    case "NotFoundError":
      return "No microphone was found: plug one in, then try again.";
    default:
      return `The microphone does not open: ${error.message}`;
  }
}
