// Says when the course was updated since this page was opened: reloading it brings the new version.
import { UPDATED, button, element } from "./elements.js";

const NUMBER = new URL("../version.txt", import.meta.url);
const opened = new URL(document.querySelector('script[src*="/run.js"]').src).searchParams.get("v");

// Ask the website for its version, without a wait; without a network, nothing is known.
export async function tellUpdate() {
  if (document.querySelector(".updated") || !navigator.onLine) return;
  const answer = await fetch(NUMBER, { cache: "no-store" }).catch(() => null);
  if (!answer?.ok || (await answer.text()).trim() === opened) return;
  const reload = button("Reload", "Reload this page", () => location.reload());
  const note = element("div", { className: "updated", role: "alert" }, element("p", { textContent: UPDATED }), reload);
  document.body.append(note);
}
