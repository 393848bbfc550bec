// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The view by keyboard: it takes the focus, arrow keys turn it, plus and minus zoom, Home shows all.
import * as THREE from "three";

const STEP = Math.PI / 36; // of a turn by one key

// Turns a camera about the target of its controls: to the side, and up to but never over the poles.
function turn({ camera, controls }, aside, upwards) {
  const from = camera.position.clone().sub(controls.target);
  const angle = from.angleTo(camera.up);
  const next = Math.min(Math.PI - 0.01, Math.max(0.01, angle - upwards));
  const across = new THREE.Vector3().crossVectors(camera.up, from).normalize();
  from.applyAxisAngle(across, next - angle).applyAxisAngle(camera.up, aside);
  camera.position.copy(controls.target).add(from);
  controls.update();
}

function zoom({ camera, controls }, factor) {
  camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
  controls.update();
}

export function stageKeys(stage) {
  const canvas = stage.renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "The part in three dimensions. Arrow keys turn it, plus and minus zoom, Home shows all of it.");
  const keys = {
    ArrowLeft: () => turn(stage, -STEP, 0),
    ArrowRight: () => turn(stage, STEP, 0),
    ArrowUp: () => turn(stage, 0, STEP),
    ArrowDown: () => turn(stage, 0, -STEP),
    "+": () => zoom(stage, 0.8),
    "=": () => zoom(stage, 0.8),
    "-": () => zoom(stage, 1.25),
    Home: () => stage.again(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    keys[event.key]();
  });
}
