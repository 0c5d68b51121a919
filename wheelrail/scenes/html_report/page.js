"use strict";
// Interactive 3D views replace their still images if the browser supports WebGL.
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
  // Active only after a click, so that scrolling the page does not zoom.
  view.querySelector(".stage").addEventListener("click", () => view.classList.add("turning"));
  view.addEventListener("mouseleave", () => view.classList.remove("turning"));
}
// A click on a column head sorts a long table, numerically for numbers, with missing values last; the next click
// reverses the order.
for (const table of document.querySelectorAll(".long table")) {
  for (const [column, head] of [...table.tHead.rows[0].cells].entries()) {
    const button = document.createElement("button");
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.ariaSort === "ascending";
      for (const other of table.tHead.rows[0].cells) other.ariaSort = null;
      head.ariaSort = down ? "descending" : "ascending";
      const text = row => row.cells[column].textContent;
      const value = row => head.className === "number" ? parseFloat(text(row)) : text(row);
      const order = (a, b) => a < b ? -1 : a > b ? 1 : 0;
      const valid = row => !Number.isNaN(value(row));
      const rows = [...table.tBodies[0].rows];
      const sorted = rows.filter(valid).sort((a, b) => (down ? -1 : 1) * order(value(a), value(b)));
      table.tBodies[0].append(...sorted, ...rows.filter(row => !valid(row)));
    });
  }
}
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
});
