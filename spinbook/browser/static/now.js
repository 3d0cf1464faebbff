// What a cell does now, in its head, where the reader has pressed Run: its state, for how long, the last line it printed.
import { button, element } from "./elements.js";

const TICK_MS = 1000;

export class Now {
  constructor(head, name) {
    this.state = element("p", { className: "run-state", role: "status" });
    this.seconds = element("span", { className: "run-seconds" });
    this.part = element("progress", { max: 1, hidden: true, ariaLabel: "How much of the download is there" });
    this.last = element("code", { className: "run-last" });
    this.interrupt = button("Ctrl-C", `Ctrl-C: end ${name}`, () => this.stop?.());
    this.interrupt.hidden = true;
    this.place = element("div", { className: "run-now", hidden: true }, this.state, this.part, this.seconds, this.last, this.interrupt);
    head.append(this.place);
    // As in a terminal, unless the reader copies something.
    head.parentElement.addEventListener("keydown", (event) => {
      if (event.key !== "c" || !event.ctrlKey || event.altKey || event.shiftKey || !this.stop || !getSelection().isCollapsed) return;
      event.preventDefault();
      this.stop();
    });
  }

  // It starts: count the seconds until it runs.
  begin() {
    this.last.textContent = "";
    this.part.hidden = true;
    this.place.hidden = false;
    this.began = Date.now();
    this.phase("starting");
  }

  clear() {
    this.phase("");
    this.state.textContent = "";
    this.place.hidden = true;
  }

  // `phase` is starting, running, ended or failed; without it, the phase stays.
  say(text, phase) {
    if (this.state.textContent !== text) this.state.textContent = text;
    if (phase) this.phase(phase);
  }

  get starts() {
    return this.place.dataset.phase === "starting";
  }

  // Show how much of a download is there, from 0 to 1.
  progress(part) {
    this.part.hidden = part >= 1;
    this.part.value = part;
  }

  phase(phase) {
    this.place.dataset.phase = phase;
    clearInterval(this.timer);
    this.seconds.textContent = "";
    if (phase !== "starting") return void (this.part.hidden = true);
    const tick = () => (this.seconds.textContent = `${Math.floor((Date.now() - this.began) / 1000)} s`);
    this.timer = setInterval(tick, TICK_MS);
  }

  // The cell's turn is over: say so, unless its node goes on, or it was said why.
  close(failed) {
    if (this.stop || !this.state.textContent.endsWith("…")) return;
    this.say(failed ? "failed" : "done", failed ? "failed" : "ended");
  }

  line(text) {
    this.last.textContent = text.trimEnd().split("\n").at(-1);
  }

  // It can be ended by `stop` from now on; null if there is nothing to end.
  runs(stop) {
    this.stop = stop;
    this.interrupt.hidden = !stop;
  }
}
