/* What the theme leaves without a name or without access by keyboard. */
document.querySelector(".md-search")?.setAttribute("aria-label", "Search");
document.querySelectorAll(".md-nav[data-md-level='2'], .md-code__nav").forEach((nav, index) => {
  const title = nav.querySelector(".md-nav__title")?.textContent.trim();
  nav.setAttribute("aria-label", title || `Code ${index + 1}`);
  nav.removeAttribute("aria-labelledby");
});
for (const region of document.querySelectorAll("pre > code, .md-typeset__scrollwrap, .output")) {
  region.tabIndex = 0;
}
