// A double click on a picture zooms into it and back, Ctrl and the wheel by steps; a drag moves it.
for (const svg of document.querySelectorAll("svg.plot")) {
  const whole = svg.getAttribute("viewBox").split(" ").map(Number);
  let view = [...whole], from = null;
  const show = () => svg.setAttribute("viewBox", view.join(" "));
  const at = e => { const r = svg.getBoundingClientRect(); return [(e.clientX - r.left) / r.width, (e.clientY - r.top) / r.height]; };
  const zoom = (e, f) => {
    const [x, y] = at(e);
    view = [view[0] + x * view[2] * (1 - f), view[1] + y * view[3] * (1 - f), view[2] * f, view[3] * f];
    show();
  };
  svg.addEventListener("wheel", e => {
    if (!e.ctrlKey && view[2] === whole[2]) return;
    e.preventDefault();
    zoom(e, Math.min(e.deltaY < 0 ? 0.8 : 1.25, whole[2] / view[2]));
  }, { passive: false });
  svg.addEventListener("pointerdown", e => { if (view[2] < whole[2]) { from = at(e); svg.setPointerCapture(e.pointerId); } });
  svg.addEventListener("pointermove", e => {
    if (!from) return;
    const [x, y] = at(e);
    view[0] += (from[0] - x) * view[2]; view[1] += (from[1] - y) * view[3];
    from = [x, y];
    show();
  });
  svg.addEventListener("pointerup", () => { from = null; });
  svg.addEventListener("dblclick", e => { if (view[2] < whole[2]) { view = [...whole]; show(); } else zoom(e, 0.25); });
}
