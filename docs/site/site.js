// Mends what the theme lacks for keyboards and screen readers: a name of the search, focus for what scrolls, and no empty
// headings of columns.
document.querySelector(".md-search").setAttribute("aria-label", "Search");
for (const heading of document.querySelectorAll("th:empty")) heading.replaceWith(document.createElement("td"));
addEventListener("load", () => {
  for (const each of document.querySelectorAll(".highlight code, .md-typeset__scrollwrap, .md-search__scrollwrap"))
    each.tabIndex = 0;
});
