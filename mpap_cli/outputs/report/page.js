"use strict";
/* Draws the charts, sorts the clusters, filters the presses, switches light and dark. */
const charts = JSON.parse(document.getElementById("charts").textContent);
for (const figure of document.querySelectorAll("[data-chart]")) {
  figure.chart = new Chart(figure.querySelector(".plot"), charts[figure.dataset.chart]);
}

function press(button) {
  for (const other of button.parentElement.querySelectorAll("button")) {
    other.setAttribute("aria-pressed", String(other === button));
  }
}

for (const button of document.querySelectorAll("[data-sort]")) {
  button.addEventListener("click", () => {
    press(button);
    const cards = button.closest("section").querySelector(".cards");
    const key = button.dataset.sort;
    const sign = key === "number" ? 1 : -1;
    const order = (a, b) => sign * (a.dataset[key] - b.dataset[key]) || a.dataset.number - b.dataset.number;
    cards.append(...[...cards.children].sort(order));
  });
}

for (const button of document.querySelectorAll("[data-show]")) {
  button.addEventListener("click", () => {
    press(button);
    for (const card of button.closest("section").querySelectorAll(".press")) {
      card.hidden = button.dataset.show !== "all" && !card.classList.contains(button.dataset.show);
    }
  });
}

const theme = document.getElementById("theme");
theme.addEventListener("click", () => {
  const themes = ["auto", "light", "dark"];
  const next = themes[(themes.indexOf(document.documentElement.dataset.theme) + 1) % 3];
  document.documentElement.dataset.theme = next;
  theme.textContent = next;
});
