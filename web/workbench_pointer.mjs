// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What pointer and keys do on the view: point at a face, choose it, draw a rectangle, turn the camera.

// does: {point(hit, x, y), choose(hit, add), within(faces, add, sides)}; boxing(): whether a drag draws a rectangle.
export function listen(view, frame, boxing, does) {
  const { canvas } = view;
  let pressed = null;
  let last = null;

  function rectangle(event) {
    const box = canvas.getBoundingClientRect();
    const [left, right] = [pressed.x, event.clientX].sort((a, b) => a - b);
    const [top, bottom] = [pressed.y, event.clientY].sort((a, b) => a - b);
    Object.assign(frame.style, { left: `${left - box.left}px`, top: `${top - box.top}px`, width: `${right - left}px`,
      height: `${bottom - top}px` });
    return [left, top, right, bottom];
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (!event.isPrimary) return (pressed = null);
    pressed = { x: event.clientX, y: event.clientY, moved: false };
    if (!boxing()) return;
    canvas.setPointerCapture(event.pointerId);
    frame.hidden = false;
    rectangle(event);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (pressed) {
      pressed.moved ||= Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > (event.pointerType === "touch" ? 9 : 4);
      if (!frame.hidden) rectangle(event);
      return;
    }
    if (!last) requestAnimationFrame(() => {
      if (last) does.point(view.pick(...last), ...last);
      last = null;
    });
    last = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerleave", () => {
    last = null;
    does.point(null);
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!pressed) return;
    const { moved } = pressed;
    if (!frame.hidden) {
      const sides = rectangle(event);
      frame.hidden = true;
      if (moved) does.within(view.facesWithin(...sides), event.shiftKey, sides);
    }
    if (!moved) does.choose(view.pick(event.clientX, event.clientY), event.shiftKey || event.ctrlKey || event.metaKey);
    pressed = null;
  });
  canvas.addEventListener("pointercancel", () => {
    pressed = null;
    frame.hidden = true;
  });

  const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] };
  canvas.addEventListener("keydown", (event) => {
    if (turns[event.key]) view.turn(...turns[event.key]);
    else if (event.key === "+" || event.key === "=") view.zoom(0.85);
    else if (event.key === "-") view.zoom(1.18);
    else return;
    event.preventDefault();
  });
}
