/* What the theme leaves without a name or without access by keyboard; it goes on changing its elements. */
function mend() {
  document.querySelector(".md-search:not([aria-label])")?.setAttribute("aria-label", "Search");
  document.querySelectorAll(".md-code__nav:not([data-named])").forEach((nav) => {
    nav.setAttribute("aria-label", `Code ${nav.closest("pre")?.id || ""}`);
    nav.setAttribute("data-named", "");
  });
  document.querySelectorAll(".md-nav:not([data-named])").forEach((nav, index) => {
    const title = nav.querySelector(".md-nav__title")?.textContent.trim() || "Pages";
    nav.setAttribute("aria-label", index ? `${title} (${index + 1})` : title);
    nav.removeAttribute("aria-labelledby");
    nav.setAttribute("data-named", "");
  });
  const regions = "pre > code, .md-typeset__scrollwrap, .output";
  for (const region of document.querySelectorAll(regions)) {
    if (region.tabIndex !== 0) region.tabIndex = 0;
  }
}
mend();
new MutationObserver(mend).observe(document.body, {
  subtree: true,
  childList: true,
  attributes: true,
  attributeFilter: ["tabindex"],
});
