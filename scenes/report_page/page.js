"use strict";
// Views come to life where the browser can draw them; else their pictures stay.
for (const view of document.querySelectorAll(".view")) {
  const canvas = document.createElement("canvas");
  if (!(canvas.getContext("webgl2") || canvas.getContext("webgl"))) {
    view.querySelector(".message").hidden = false;
    continue;
  }
  const frame = document.createElement("iframe");
  frame.title = view.querySelector("img").alt;
  frame.srcdoc = JSON.parse(view.querySelector("script").textContent);
  frame.addEventListener("load", () => view.classList.add("alive"));
  view.querySelector(".stage").append(frame);
  view.querySelector(".hint").hidden = false;
  // Only after a click, so that scrolling past does not zoom.
  view.querySelector(".stage").addEventListener("click", () => view.classList.add("turning"));
  view.addEventListener("mouseleave", () => view.classList.remove("turning"));
}
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
});
