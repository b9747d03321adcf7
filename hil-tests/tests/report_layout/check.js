// What is wrong with the layout of this page, as lines of text, told to the page around it.
addEventListener("load", () => {
  const wrong = [];
  const boxes = [];
  const visible = e => !e.closest("details:not([open]) > :not(summary)") && e.checkVisibility();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, parent = node.parentElement;
    if (!node.data.trim() || ["SCRIPT", "STYLE", "title", "desc"].includes(parent.tagName) || !visible(parent)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const r of range.getClientRects()) if (r.width > 0) boxes.push({ r, parent, text: node.data.trim().slice(0, 40) });
  }
  for (let i = 0; i < boxes.length; i++) for (let j = i + 1; j < boxes.length; j++) {
    const a = boxes[i].r, b = boxes[j].r;
    if (boxes[i].parent === boxes[j].parent) continue;
    if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1.5)
      wrong.push(`"${boxes[i].text}" and "${boxes[j].text}" lie over each other`);
  }
  for (const { r, parent, text } of boxes) {
    const svg = parent.closest("svg");
    if (!svg) continue;
    const s = svg.getBoundingClientRect();
    if (r.left < s.left - 0.5 || r.right > s.right + 0.5 || r.top < s.top - 0.5 || r.bottom > s.bottom + 0.5)
      wrong.push(`"${text}" leaves its picture`);
  }
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) wrong.push(`the page is ${root.scrollWidth} px wide in ${root.clientWidth} px`);
  // Contrast by WCAG 2: what is read against the ground below it.
  const light = c => { const v = c / 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; };
  const luminance = css => { const [r, g, b] = css.match(/[\d.]+/g).map(Number); return 0.2126 * light(r) + 0.7152 * light(g) + 0.0722 * light(b); };
  const ground = e => {
    const svg = e.closest("svg");
    if (svg) return getComputedStyle(svg.querySelector(".ground")).fill;
    for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor; if (!c.endsWith(", 0)")) return c; }
    return "rgb(255, 255, 255)";
  };
  const told = new Set();
  for (const { parent, text } of boxes) {
    const style = getComputedStyle(parent), colour = parent.closest("svg") ? style.fill : style.color;
    const [a, b] = [luminance(colour), luminance(ground(parent))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (contrast < 4.5 && !told.has(colour)) { told.add(colour); wrong.push(`"${text}" has a contrast of ${contrast.toFixed(1)}`); }
  }
  for (const row of document.querySelectorAll("tr")) if (window.isPaper && getComputedStyle(row).breakInside !== "avoid") { wrong.push("a row may be cut by the end of a page"); break; }
  const beside = document.querySelector(".certificate .columns");
  if (beside && innerWidth > 1000 && Math.abs(beside.children[0].getBoundingClientRect().top - beside.children[1].getBoundingClientRect().top) > 30)
    wrong.push("half the page beside the circle is empty");
  for (const head of document.querySelectorAll("h2, h3")) if (window.isPaper && getComputedStyle(head).breakAfter !== "avoid") { wrong.push("a heading may be the last line of a page"); break; }
  for (const svg of document.querySelectorAll("svg"))
    if (svg.getAttribute("role") !== "img" || !svg.querySelector(":scope > title").textContent || !svg.querySelector(":scope > desc").textContent)
      wrong.push("a picture without words");
  const dark = luminance(getComputedStyle(document.body).backgroundColor) < 0.1;
  parent.postMessage([`texts ${boxes.length}, pictures ${document.querySelectorAll("svg").length}, ${dark ? "dark" : "light"}, ${innerWidth} px`, ...new Set(wrong)].join("\n"), "*");
});
