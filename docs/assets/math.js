// Typesets what pymdownx.arithmatex has marked as mathematics, with the KaTeX beside.
for (const element of document.querySelectorAll(".arithmatex")) {
  const text = element.textContent;
  const display = text.startsWith("\\[");
  katex.render(text.slice(2, -2), element, { displayMode: display, throwOnError: true });
}
// a formula that is wider than the text around it scrolls by itself
document.fonts.ready.then(() => {
  for (const formula of document.querySelectorAll("span.arithmatex > .katex")) {
    const text = formula.closest("p, li");
    if (text && formula.getBoundingClientRect().width > text.clientWidth) formula.classList.add("wide");
  }
});
