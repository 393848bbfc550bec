// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The handle that pushes or pulls the chosen face: the distance is shown in millimetres while it is dragged, and the
// face moves in the view at once; the session moves it on release.
import { digits } from "./workbench_words.mjs";

export class Pull {
  constructor(context) {
    Object.assign(this, context);
  }

  get dragging() {
    return this.handles.dragged === "pull";
  }

  // A scene has come: of a shape that is tried, or of another one.
  seen(kind) {
    this.live = this.dragging && kind === "result";
  }

  // One try at a time is under way; meanwhile only the newest distance is kept.
  attempt(distance) {
    this.wanted = distance;
    if (this.waiting || !distance) return;
    this.waiting = true;
    this.wanted = null;
    this.send("drag", { push: { faces: this.numbers(), distance } });
  }

  // The session makes ready for a drag of other faces, of any distance.
  prepare(faces) {
    if (String(faces) === this.prepared) return;
    this.prepared = String(faces);
    this.send("prepare", { push: { faces, distance: 0.001 } });
  }

  handled() {
    this.waiting = false;
    if (this.dragging && this.wanted) this.attempt(this.wanted);
  }

  facesChanged() {
    const { view } = this;
    const face = [...this.chosen()][0];
    const edits = this.byId("edit").open && this.chosen().size === 1 && view.surface && !this.state().faces[face]?.locked;
    const place = edits ? view.symbols.centre(view.surface, face) : null;
    if (!place) {
      this.prepared = "";
      return this.handles.set("pull", null);
    }
    this.prepare(this.numbers());
    const base = 0.12 * view.size;
    this.handles.set("pull", { at: place.at, direction: place.normal, length: base, colour: "#b85c00",
      move: (handle, x, y) => {
        this.distance = this.rounded(this.handles.along(handle, x, y) - base);
        handle.length = base + this.distance;
        handle.words = `${this.distance > 0 ? "+" : ""}${digits(1000 * this.distance)} mm`;
        if (!this.live) this.preview(face, place.normal, this.distance);
        this.attempt(this.distance);
      },
      end: (_, cancelled) => {
        const { distance } = this;
        if (distance && !cancelled) {
          this.byId("distance").value = digits(1000 * distance);
          const id = this.send("push", { faces: this.numbers(), distance });
          this.released(id);
          this.rest();
          if (id) return;
        }
        this.rest();
        this.refused();
      } });
  }

  // Nothing is tried any more.
  rest() {
    this.distance = 0;
    this.live = this.waiting = false;
    this.wanted = null;
  }

  // A tenth of a millimetre, or finer for small parts.
  rounded(x) {
    const step = this.view.size < 0.02 ? 1e-5 : 1e-4;
    return Number((Math.round(x / step) * step).toFixed(6)) + 0;
  }

  // Moves the points of a face in the view.
  preview(face, normal, distance) {
    const { view } = this;
    const { triangles } = view.scene;
    const moved = new Set((view.surface.trianglesOfFaces.get(face) || []).flatMap((t) => [0, 1, 2].map((k) => triangles[3 * t + k])));
    for (const [name, indices] of [["body", triangles], ["lines", view.surface.edges]]) {
      const position = view[name].geometry.getAttribute("position");
      for (let i = 0; i < indices.length; i++) {
        if (!moved.has(indices[i])) continue;
        for (let k = 0; k < 3; k++)
          position.array[3 * i + k] = view.places[3 * indices[i] + k] + distance * normal.getComponent(k);
      }
      position.needsUpdate = true;
    }
    view.stage.touch();
  }

  // The view goes back to what the session has.
  refused() {
    if (this.dragging) return this.handled();
    if (this.view.scene) this.view.deform();
    this.facesChanged();
  }
}
