// Typesets what pymdownx.arithmatex has marked as mathematics, with the KaTeX beside.
for (const element of document.querySelectorAll(".arithmatex")) {
  const text = element.textContent;
  const display = text.startsWith("\\[");
  katex.render(text.slice(2, -2), element, { displayMode: display, throwOnError: true });
}
