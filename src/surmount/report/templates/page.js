// Draws the plots, each as wide as its column, and opens everything for printing.
"use strict";

(() => {
  const touch = matchMedia("(pointer: coarse)").matches;
  const options = {
    // No buttons: they cover the plots, and one of them would send the chart elsewhere.
    displayModeBar: false,
    displaylogo: false,
    showSendToCloud: false,
    plotlyServerURL: "",
  };

  const draw = (element) => {
    const source = element.querySelector("script");
    if (source === null) return;
    const { data, layout } = JSON.parse(source.textContent);
    source.remove();
    // On a touch screen a finger on a plot scrolls the page.
    layout.dragmode = touch ? false : "zoom";
    Plotly.newPlot(element, data, layout, options);
  };

  // Wider or narrower: the window was resized, the phone turned.
  const resized = new ResizeObserver((entries) => {
    for (const { target } of entries) Plotly.Plots.resize(target);
  });

  // One after the other from the top, so that the page can be read meanwhile.
  const waiting = [...document.querySelectorAll(".plot")];
  const drawNext = () => {
    const element = waiting.shift();
    if (element === undefined) return;
    draw(element);
    resized.observe(element);
    setTimeout(drawNext);
  };
  document.documentElement.classList.add("interactive");
  drawNext();

  // The still picture is in the page already: its download need not repeat it.
  for (const link of document.querySelectorAll("a.svg")) {
    link.href = link.closest("figure").querySelector("img.still").src;
  }

  addEventListener("beforeprint", () => {
    for (const fold of document.querySelectorAll("details:not([open])")) {
      fold.open = true;
      fold.dataset.opened = "";
    }
  });
  addEventListener("afterprint", () => {
    for (const fold of document.querySelectorAll("details[data-opened]")) {
      fold.open = false;
      delete fold.dataset.opened;
    }
  });
})();
