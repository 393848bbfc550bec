// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What the report's view and the live view share: a lit scene with a camera to orbit, a surface in
// colours of a field, the colour bar, numbers as text.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { fitDistance } from "./fit.mjs";
import { Pace } from "./pace.mjs";
import { stageKeys } from "./stage_keys.mjs";
import { themed } from "./theme.mjs";

export const number = (x) =>
  Math.abs(x) >= 1e4 || (x !== 0 && Math.abs(x) < 1e-2) ? x.toExponential(2) : x.toPrecision(4);

// The scene fills `view`; `frame(now)` is called before each picture. With `onDemand` a picture is drawn where the camera
// moved or `touch` was called, else always. While the camera moves, slow pictures have fewer pixels.
export function makeStage(view, frame, { onDemand = false } = {}) {
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  } catch (error) {
    view.textContent = "The 3D view needs WebGL, which this browser does not offer.";
    throw error;
  }
  const sharpest = Math.min(window.devicePixelRatio, 2);
  renderer.setPixelRatio(sharpest);
  view.appendChild(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0xb0b4bc, 1.6));
  const lamp = new THREE.DirectionalLight(0xffffff, 1.8);
  const camera = new THREE.PerspectiveCamera(35, 1, 0.001, 20);
  camera.up.set(0, 0, 1);
  camera.add(lamp);
  lamp.position.set(0.6, 0.8, 1);
  scene.add(camera);
  const controls = new OrbitControls(camera, renderer.domElement);
  let touched = true;
  const touch = () => (touched = true);
  controls.addEventListener("change", touch);

  // The camera turns while it is dragged and until it has rested for a moment.
  const pace = new Pace();
  const turned = [];
  let [turning, pressed, rests] = [false, false, 0];
  function setTurning(on) {
    if (on === turning) return;
    turning = on;
    for (const call of turned) call(on);
    touch();
  }
  function moved() {
    setTurning(true);
    clearTimeout(rests);
    if (!pressed) rests = setTimeout(() => setTurning(false), 300);
  }
  const press = (on) => () => {
    pressed = on;
    moved();
  };
  controls.addEventListener("start", press(true));
  controls.addEventListener("change", moved);
  controls.addEventListener("end", press(false));
  const sharpen = (ratio) => ratio === renderer.getPixelRatio() || renderer.setPixelRatio(ratio);
  themed((background) => {
    scene.background = new THREE.Color(background);
    touch();
  });

  // What is fitted into the picture, seen from where the camera is, until the person zooms or moves it.
  let fitted = null;
  let last = null; // what was aimed at

  const needed = (sizes, from, margin) =>
    fitDistance(sizes, from.toArray(), camera.up.toArray(), camera.fov, camera.aspect, margin);

  // Looks at a box from a direction: all of it is in the picture, whatever its shape and that of the view. `margin`: a
  // factor of room on each side, where what is shown may grow.
  function aim(box, from, margin) {
    const centre = box.getCenter(new THREE.Vector3());
    const extent = box.getSize(new THREE.Vector3());
    const size = extent.length() || 1;
    const direction = new THREE.Vector3(...from).normalize();
    const distance = needed(extent.toArray(), direction, margin) || size;
    camera.near = size * 0.001;
    camera.far = size * 20 + 2 * distance;
    camera.updateProjectionMatrix();
    camera.position.copy(direction.multiplyScalar(distance).add(centre));
    controls.target.copy(centre);
    controls.update();
    last = [box.clone(), from, margin];
    fitted = { extent: extent.toArray(), margin, position: camera.position.clone() };
    return size;
  }

  // A view of another shape shows the whole box again where the camera still is where it was aimed.
  function resize() {
    const { clientWidth, clientHeight } = view;
    renderer.setSize(clientWidth, clientHeight);
    touch();
    camera.aspect = Math.max(1, clientWidth) / Math.max(1, clientHeight);
    camera.updateProjectionMatrix();
    if (!fitted || camera.position.distanceTo(fitted.position) > 1e-3 * camera.near) return;
    const from = camera.position.clone().sub(controls.target);
    camera.position.copy(from.normalize().multiplyScalar(needed(fitted.extent, from, fitted.margin)).add(controls.target));
    controls.update();
    fitted.position.copy(camera.position);
  }
  new ResizeObserver(resize).observe(view);
  resize();

  function draw(now) {
    frame(now);
    controls.update();
    if (touched || !onDemand) {
      sharpen(turning ? sharpest * pace.picture(now) : sharpest);
      renderer.render(scene, camera);
    }
    touched = false;
    requestAnimationFrame(draw);
  }
  const start = () => requestAnimationFrame(draw);
  const stage = {
    renderer, scene, camera, controls, aim, start, touch,
    again: () => last && aim(...last),
    // `call(on)` when the camera begins to turn, and when it rests.
    onTurning: (call) => turned.push(call),
    get sharpness() {
      return renderer.getPixelRatio() / sharpest;
    },
  };
  stageKeys(stage);
  return stage;
}

// A surface of triangles whose points have colours: lit, unless the material is given.
export function makeBody(points, triangles, given) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(points.length), 3));
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
  geometry.computeBoundingBox();
  const material = given || new THREE.MeshStandardMaterial({
    vertexColors: true,
    flatShading: true,
    roughness: 0.75,
    metalness: 0,
    side: THREE.DoubleSide,
  });
  return new THREE.Mesh(geometry, material);
}

// Colours of values between low and high; what is no number is grey, no values at all a light grey.
export function paint(body, values, low, high, colour) {
  const attribute = body.geometry.getAttribute("color");
  const linear = new THREE.Color();
  if (!values) attribute.array.fill(0.72);
  else
    for (let i = 0; i < values.length; i++) {
      const v = values[i];
      if (Number.isFinite(v)) {
        const rgb = colour(high > low ? (v - low) / (high - low) : 0);
        linear.setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, THREE.SRGBColorSpace);
      } else linear.setRGB(0.5, 0.5, 0.5);
      attribute.setXYZ(i, linear.r, linear.g, linear.b);
    }
  attribute.needsUpdate = true;
}

export function drawBar(canvas, colour) {
  const strip = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; x++) {
    const [r, g, b] = colour(x / (canvas.width - 1));
    strip.fillStyle = `rgb(${r},${g},${b})`;
    strip.fillRect(x, 0, 1, canvas.height);
  }
}
