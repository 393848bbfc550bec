// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The plane as it is looked at: WebGL below for the coloured field, a canvas above for lines and handles,
// both under one map from metres to pixels; wheel and buttons zoom, whoever asks pans. It is drawn when
// something was touched, not always.
import * as THREE from "three";
import { themed } from "./theme.mjs";

export function makePlane(view, frame) {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  const ratio = Math.min(window.devicePixelRatio, 2);
  renderer.setPixelRatio(ratio);
  const canvas = document.createElement("canvas");
  canvas.id = "over";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "The shape in the plane. Arrow keys move the view, plus and minus zoom, F shows all of it.");
  view.prepend(renderer.domElement, canvas);
  const pen = canvas.getContext("2d");
  const scene = new THREE.Scene();
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -10, 10);
  const plane = { renderer, canvas, scene, camera, width: 1, height: 1, centre: [0, 0], scale: 1 };

  function place() {
    const { width, height, centre, scale } = plane;
    camera.left = centre[0] - width / (2 * scale);
    camera.right = centre[0] + width / (2 * scale);
    camera.bottom = centre[1] - height / (2 * scale);
    camera.top = centre[1] + height / (2 * scale);
    camera.updateProjectionMatrix();
    plane.touched = true;
  }
  plane.touch = () => (plane.touched = true);
  themed((background) => {
    scene.background = new THREE.Color(background);
    plane.touch();
  });

  plane.toScreen = (x, y) => [plane.width / 2 + (x - plane.centre[0]) * plane.scale,
    plane.height / 2 - (y - plane.centre[1]) * plane.scale];
  plane.toWorld = (x, y) => [plane.centre[0] + (x - plane.width / 2) / plane.scale,
    plane.centre[1] - (y - plane.height / 2) / plane.scale];

  // Shows a box {min, max} with a margin.
  plane.fit = (min, max) => {
    plane.centre = [0, 1].map((k) => 0.5 * (min[k] + max[k]));
    plane.scale = 0.8 * Math.min(plane.width / Math.max(max[0] - min[0], 1e-9),
      plane.height / Math.max(max[1] - min[1], 1e-9));
    place();
  };
  plane.zoom = (factor, x = plane.width / 2, y = plane.height / 2) => {
    const at = plane.toWorld(x, y);
    plane.scale *= factor;
    const now = plane.toWorld(x, y);
    plane.centre = plane.centre.map((c, k) => c + at[k] - now[k]);
    place();
  };
  plane.pan = (dx, dy) => {
    plane.centre = [plane.centre[0] - dx / plane.scale, plane.centre[1] + dy / plane.scale];
    place();
  };

  function resize() {
    plane.width = Math.max(1, view.clientWidth);
    plane.height = Math.max(1, view.clientHeight);
    renderer.setSize(plane.width, plane.height);
    canvas.width = plane.width * ratio;
    canvas.height = plane.height * ratio;
    canvas.style.width = `${plane.width}px`;
    canvas.style.height = `${plane.height}px`;
    place();
  }
  new ResizeObserver(resize).observe(view);
  resize();

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    plane.zoom(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
  }, { passive: false });

  const steps = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
  canvas.addEventListener("keydown", (event) => {
    if (!steps[event.key]) return;
    event.preventDefault();
    plane.pan(...steps[event.key]);
  });

  function draw() {
    requestAnimationFrame(draw);
    if (!plane.touched) return;
    plane.touched = false;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, plane.width, plane.height);
    frame(pen);
    renderer.render(scene, camera);
  }
  plane.start = draw;
  return plane;
}
