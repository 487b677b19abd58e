"""The look of the report page."""

CSS = """
:root { --ink: #1f2328; --soft: #59636e; --line: #d8dee4; --paper: #ffffff; --tint: #f6f8fa; --accent: #0072b2; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: var(--paper);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.8rem; line-height: 1.2; margin: 0.5rem 0 1rem; overflow-wrap: anywhere; }
h2 { font-size: 1.35rem; margin: 2.5rem 0 0.75rem; padding-bottom: 0.3rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1.08rem; margin: 2rem 0 0.5rem; }
code { font-family: ui-monospace, "SF Mono", "Liberation Mono", monospace; font-size: 0.9em; color: var(--soft); }
.verdict { padding: 0.6rem 0.9rem; border-left: 4px solid; background: var(--tint); border-radius: 0 4px 4px 0; }
.verdict.good { border-color: #009e73; } .verdict.bad { border-color: #d55e00; }
.links { display: flex; flex-wrap: wrap; gap: 0.5rem; }
.button { padding: 0.3rem 0.8rem; border: 1px solid var(--line); border-radius: 6px; color: var(--accent);
  text-decoration: none; background: var(--tint); }
.button:hover, .button:focus { border-color: var(--accent); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 0.93rem; }
th, td { text-align: left; vertical-align: top; padding: 0.34rem 0.7rem 0.34rem 0; border-bottom: 1px solid var(--line); }
thead th { color: var(--soft); font-weight: 600; border-bottom-width: 2px; white-space: nowrap; }
tbody th { font-weight: 500; min-width: 8rem; }
td.why { min-width: 15rem; padding-right: 0; }
td.n { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
thead th.n { text-align: right; }
tr.chosen td { background: #e8f3ec; } tr.chosen td:first-child { font-weight: 600; padding-left: 0.4rem; }
tr.refused td { color: var(--soft); }
tr.group th { color: var(--soft); font-size: 0.85rem; padding-top: 0.9rem; }
td.ok { color: #00704f; } td.no { color: #b34700; font-weight: 600; }
figure { margin: 1rem 0 1.75rem; }
img { display: block; max-width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: 0.88rem; margin-top: 0.3rem; max-width: 46rem; }
@media (max-width: 40rem) { main { padding: 1rem 0.8rem 3rem; } h1 { font-size: 1.45rem; } table { font-size: 0.86rem; } }
@media print { .button { display: none; } main { max-width: none; } }
"""
