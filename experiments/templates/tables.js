"use strict";
// Tables that are sorted by a click on the head of a column, as often as one likes.

/** The number that a cell begins with; null of a cell that begins with none. @param {string} text */
function leading(text) {
  const found = /^[<≈]?\s*([+−-]?[\d.]+(?:e[+-]?\d+)?)/i.exec(text.trim());
  return found ? Number(found[1].replace("−", "-")) : null;
}

/** @param {string} a @param {string} b @returns {number} numbers before words, and both before a dash */
function order(a, b) {
  const [x, y] = [leading(a), leading(b)];
  if (x !== null && y !== null) return x - y;
  if (x !== null || y !== null) return x === null ? 1 : -1;
  return a.localeCompare(b);
}

/** @param {HTMLTableElement} table @param {number} column @param {boolean} falling */
function sort(table, column, falling) {
  const body = table.tBodies[0];
  const text = (row) => row.cells[column].textContent;
  const isMissing = (row) => ["-", "–", ""].includes(text(row).trim());
  const rows = [...body.rows];
  const there = rows.filter((row) => !isMissing(row)).sort((a, b) => (falling ? -1 : 1) * order(text(a), text(b)));
  body.append(...there, ...rows.filter(isMissing));
  [...table.tHead.rows[0].cells].forEach((head, k) => head.setAttribute("aria-sort", k !== column ? "none" : falling ? "descending" : "ascending"));
}

for (const table of document.querySelectorAll("table.sheet")) {
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    if (head.title) button.title = head.title;
    head.replaceChildren(button);
    button.addEventListener("click", () => sort(table, column, head.getAttribute("aria-sort") === "ascending"));
  });
}
