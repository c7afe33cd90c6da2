// In the audio thread: collects samples between "begin" and "end", however busy the page is. Hands on
// how loud it is as a number several times a second, and at the end all of the sound.
const SHOWN = 2048; // samples

class Recorder extends AudioWorkletProcessor {
  constructor() {
    super();
    this.begin(); // Opened because somebody speaks: not a sample is lost.
    this.port.onmessage = ({ data }) => (data === "begin" ? this.begin() : this.end());
  }

  begin() {
    Object.assign(this, { blocks: [], loudest: 0, since: 0 });
  }

  end() {
    this.port.postMessage(this.blocks ?? []);
    this.blocks = null;
  }

  process([[samples]]) {
    if (!samples || !this.blocks) return true;
    this.blocks.push(samples.slice());
    for (const sample of samples) this.loudest = Math.max(this.loudest, Math.abs(sample));
    this.since += samples.length;
    if (this.since >= SHOWN) {
      this.port.postMessage(this.loudest);
      this.loudest = this.since = 0;
    }
    return true;
  }
}

registerProcessor("recorder", Recorder);
