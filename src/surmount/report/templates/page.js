// Draws figures that come into view over their pictures, and opens what is folded for printing.
"use strict";

(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const touch = matchMedia("(pointer: coarse)").matches;
  const twins = JSON.parse(document.getElementById("dark").textContent);
  const boxes = [...document.querySelectorAll(".chart")];

  const unpacked = async (id) => {
    const text = document.getElementById(id).textContent;
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };

  let charts = null;
  const ready = (async () => {
    charts = JSON.parse(await unpacked("charts"));
  })();
  let vega = null;
  const vegaReady = () => {
    vega ??= unpacked("vega").then((code) => {
      const script = document.createElement("script");
      script.textContent = code;
      document.head.append(script);
    });
    return vega;
  };

  // The specification for a width of the page: as many panels side by side as there is room for.
  const fitted = (text, available, panel) => {
    let colours = text;
    if (dark.matches) {
      for (const [light, twin] of Object.entries(twins)) colours = colours.replaceAll(light, twin);
    }
    const spec = JSON.parse(colours);
    const { columns, least_px: least } = spec.usermeta;
    spec.columns = Math.max(1, Math.min(columns, Math.floor(available / least)));
    const width = panel ?? Math.floor(available / spec.columns) - spec.usermeta.axis_px;
    for (const part of spec.concat) part.width = width;
    spec.config.legend.columns = Math.max(1, Math.floor(available / 170));
    spec.config.background = null;
    if (touch) spec.params = spec.params?.filter(({ bind }) => bind !== "scales");
    return [spec, width];
  };

  const embed = (box, spec) =>
    vegaEmbed(box, spec, { actions: false, ast: true, renderer: "svg", tooltip: { theme: dark.matches ? "dark" : "light" } });

  const draw = async (box) => {
    await Promise.all([ready, vegaReady()]);
    const figure = box.closest("figure");
    const { spec: text } = charts[box.dataset.chart];
    const available = figure.clientWidth;
    if (available === 0) return;
    box.dataset.width = available;
    let [spec, width] = fitted(text, Math.min(available, 1000), null);
    box._view?.finalize();
    box._view = await embed(box, spec);
    // What labels take is known now: once more, so that the panels fill the page and no more.
    const over = box.querySelector("svg").getBoundingClientRect().width - Math.min(available, 1000);
    if (over > 0 || over < -24) {
      box._view.finalize();
      [spec] = fitted(text, Math.min(available, 1000), Math.max(80, Math.floor(width - over / spec.columns)));
      box._view = await embed(box, spec);
    }
    const zoom = spec.usermeta.zoom && !touch;
    const picked = spec.params?.some(({ bind }) => bind === "legend");
    const hints = [
      picked ? "Click a name to pick it, with shift several." : "",
      zoom ? "Drag to move, Ctrl and wheel to zoom." : "",
    ];
    figure.querySelector(".hint").textContent = hints.join(" ");
    figure.querySelector(".tools").hidden = !(zoom || picked);
    figure.classList.add("drawn");
  };

  const attempt = (box) => {
    box._drawing = (box._drawing ?? Promise.resolve()).then(() => draw(box)).catch((error) => {
      console.warn(`${box.dataset.chart}: ${error}`);
      box.closest("figure").classList.remove("drawn"); // the picture stays
      box.replaceChildren();
    });
  };

  const inView = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        inView.unobserve(target);
        const box = target.querySelector(".chart");
        attempt(box);
        resized.observe(target);
      }
    },
    { rootMargin: "300px" },
  );
  let waiting = null;
  const resized = new ResizeObserver(() => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      for (const box of boxes) {
        const width = box.closest("figure").clientWidth;
        if (box._drawing && Math.abs(width - (box.dataset.width ?? width)) > 8) attempt(box);
      }
    }, 200);
  });
  if ("DecompressionStream" in window) {
    for (const box of boxes) inView.observe(box.closest("figure"));
    dark.addEventListener("change", () => boxes.filter((box) => box._drawing).forEach(attempt));
    ready.then(() => {
      for (const link of document.querySelectorAll("a.csv")) {
        const { csv } = charts[link.closest("figure").querySelector(".chart").dataset.chart];
        if (csv === null) {
          link.replaceWith(`data: figures/${link.download}`);
          continue;
        }
        link.addEventListener("click", () => {
          link.href = URL.createObjectURL(new Blob([csv], { type: "text/csv;charset=utf-8" }));
        });
      }
      // The picture is in the page already: its download need not repeat it.
      for (const link of document.querySelectorAll("a.svg")) {
        link.href = link.closest("figure").querySelector("img.still").src;
      }
      for (const links of document.querySelectorAll(".downloads")) links.hidden = false;
    });
  }
  for (const button of document.querySelectorAll("button.reset")) {
    button.addEventListener("click", () => attempt(button.closest("figure").querySelector(".chart")));
  }

  // Where the reader is, in the contents that stay in reach.
  const links = new Map();
  const contents = document.querySelector("nav ol");
  for (const link of document.querySelectorAll("nav a")) links.set(link.hash.slice(1), link);
  const here = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        for (const link of links.values()) link.removeAttribute("aria-current");
        const link = links.get(target.id); // none for the summary, which stands above the contents
        link?.setAttribute("aria-current", "true");
        contents.scrollTo({ left: link ? link.offsetLeft - 40 : 0 });
      }
    },
    { rootMargin: "-20% 0px -75% 0px" },
  );
  for (const section of document.querySelectorAll("main > section")) here.observe(section);

  addEventListener("beforeprint", () => {
    for (const fold of document.querySelectorAll("details:not([open]):not(.unprinted)")) {
      fold.open = true;
      fold.dataset.opened = "";
    }
    for (const fold of document.querySelectorAll("details.unprinted[open]")) {
      fold.open = false;
      fold.dataset.closed = "";
    }
  });
  addEventListener("afterprint", () => {
    for (const fold of document.querySelectorAll("details[data-opened]")) {
      fold.open = false;
      delete fold.dataset.opened;
    }
    for (const fold of document.querySelectorAll("details[data-closed]")) {
      fold.open = true;
      delete fold.dataset.closed;
    }
  });
})();
