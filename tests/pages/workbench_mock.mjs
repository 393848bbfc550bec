// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A session of the workbench made of numbers that are fixed: a plate with a hole, whose answers need no engine. So the
// page is tested by itself, with every reply at once. The windows of one session are in step, as they are with the real one.
import fs from "node:fs";
import path from "node:path";

// A plate 80 by 40 by 8 mm with a hole, as a surface with 7 faces.
function plate(height, radius) {
  const [length, width, around, layers] = [0.08, 0.04, 64, 6];
  const points = [];
  const triangles = [];
  const faces = [];
  const rim = (a) => {
    const [c, s] = [Math.cos(a), Math.sin(a)];
    const f = Math.min(length / 2 / Math.abs(c || 1e-12), width / 2 / Math.abs(s || 1e-12));
    return [c * f, s * f];
  };
  const corner = Math.atan2(width, length);
  const angles = [...Array.from({ length: around }, (_, i) => (2 * Math.PI * i) / around), corner, Math.PI - corner,
    Math.PI + corner, 2 * Math.PI - corner].sort((a, b) => a - b);
  const grid = [0, height].map((z) => Array.from({ length: layers + 1 }, (_, l) => angles.map((a) => {
    const f = (l / layers) ** 1.5;
    const [x, y] = rim(a);
    points.push([x * f + radius * Math.cos(a) * (1 - f), y * f + radius * Math.sin(a) * (1 - f), z]);
    return points.length - 1;
  })));
  const quad = (a, b, c, d, face) => {
    triangles.push(a, b, c, a, c, d);
    faces.push(face, face);
  };
  const n = angles.length;
  for (let i = 0; i < n; i++) {
    const j = (i + 1) % n;
    for (let l = 0; l < layers; l++) {
      quad(grid[0][l][j], grid[0][l + 1][j], grid[0][l + 1][i], grid[0][l][i], 1);
      quad(grid[1][l][i], grid[1][l + 1][i], grid[1][l + 1][j], grid[1][l][j], 0);
    }
    quad(grid[1][0][i], grid[1][0][j], grid[0][0][j], grid[0][0][i], 6);
    const middle = (angles[i] + (j ? angles[j] : 2 * Math.PI)) / 2;
    const side = middle < corner || middle > 2 * Math.PI - corner ? 2 : middle < Math.PI - corner ? 4 : middle < Math.PI + corner ? 3 : 5;
    quad(grid[0][layers][i], grid[0][layers][j], grid[1][layers][j], grid[1][layers][i], side);
  }
  return { points, triangles, faces };
}

function pack(header, blocks) {
  const full = { ...header, blocks: blocks.map(({ name, type, values }) => ({ name, type, count: values.length })) };
  const text = Buffer.from(JSON.stringify(full).padEnd(Math.ceil(JSON.stringify(full).length / 4) * 4));
  const size = Buffer.alloc(4);
  size.writeUInt32LE(text.length);
  return Buffer.concat([size, text, ...blocks.map(({ type, values }) =>
    Buffer.from((type === "u4" ? Uint32Array : Float32Array).from(values).buffer))]);
}

const materials = ["abs", "aluminium", "petg", "pla", "steel"];

export class Mock {
  constructor() {
    this.sockets = new Set();
    this.received = [];
    this.clients = 0;
    this.now = { height: 0.008, radius: 0.008, conditions: [], material: null, locked: [], answer: null, script: [] };
    this.past = [];
    this.future = [];
    this.file = "plate.stl";
    this.delay = 0; // of replies (ms)
    this.scene = 1;
  }

  state() {
    const { height, radius, conditions, material, locked, answer, script } = this.now;
    const face = (index, kind, area, normal, more = {}) => ({ index, kind, area, normal, locked: locked.includes(index), ...more });
    const top = 0.08 * 0.04 - Math.PI * radius ** 2;
    return { type: "state", revision: this.received.length, file: this.file, unit: "mm", units_plausible: !this.implausible,
      size: [0.08, 0.04, height], repair: { sound: true, log: ["12 doubled points were joined."] },
      faces: this.file ? [face(1, "plane", top, [0, 0, 1]), face(2, "plane", top, [0, 0, -1]), face(3, "plane", 0.04 * height, [1, 0, 0]),
        face(4, "plane", 0.04 * height, [-1, 0, 0]), face(5, "plane", 0.08 * height, [0, 1, 0]), face(6, "plane", 0.08 * height, [0, -1, 0]),
        face(7, "hole", 2 * Math.PI * radius * height, null, { radius })] : [],
      conditions: conditions.map((c, i) => ({ ...c, index: i + 1 })), materials,
      material: material && { name: material, young: 2.3e9, poisson: 0.35, strength: 4.5e7, density: 1240 },
      mass: material ? top * height * 1240 : undefined, script: ['local part = assert(bw.workbench.open("plate.stl"))', ...script],
      part: 1, undo: this.past.length > 0, redo: this.future.length > 0, saved: this.saved, advice: this.advice || [], answer, latency_ms: 12 };
  }

  picture() {
    const { height, radius, answer } = this.now;
    const { points, triangles, faces } = plate(height, radius);
    const blocks = [{ name: "positions", type: "f4", values: points.flat() }, { name: "triangles", type: "u4", values: triangles },
      { name: "faces", type: "u4", values: faces }];
    if (answer) {
      const near = ([x, y]) => (radius / Math.max(radius, Math.hypot(x, y))) ** 2 * (y * y) / Math.max(1e-9, x * x + y * y);
      blocks.push({ name: "von_mises", type: "f4", values: points.map((p) => 1e6 * (2 + 14 * near(p) + 3 * (0.04 - p[0]) / 0.08)) },
        { name: "displacement", type: "f4", values: points.flatMap(([x]) => [0, 0, -2e-5 * ((x + 0.04) / 0.08) ** 2]) });
    }
    return pack({ type: "scene", scene: this.scene, revision: this.received.length,
      colours: [[36, 56, 140], [42, 130, 190], [120, 200, 150], [245, 220, 110], [235, 130, 50], [180, 20, 30]] }, blocks);
  }

  tell(reply, picture = false) {
    for (const socket of this.sockets) {
      if (picture && this.file) socket.send(this.picture());
      socket.send(JSON.stringify({ ...this.state(), reply }));
    }
  }

  edit(change, line) {
    this.past.push(this.now);
    this.future = [];
    this.now = { ...this.now, answer: null, ...change, script: [...this.now.script, line] };
  }

  handle(message, socket) {
    this.received.push(message);
    const { conditions } = this.now;
    const what = message.do;
    const add = (condition) => this.edit({ conditions: [...conditions, condition] }, `part:${what} {faces = {${message.faces || ""}}}`);
    const size = (v) => Math.hypot(...v);
    const does = {
      fix: () => add({ kind: "fix", faces: message.faces }),
      load: () => add({ kind: "force", faces: message.faces, vector: message.force, value: size(message.force) }),
      pressure: () => add({ kind: "pressure", faces: message.faces, value: message.pressure }),
      moment: () => add({ kind: "moment", faces: message.faces, vector: message.moment, value: size(message.moment) }),
      gravity: () => add({ kind: "gravity", vector: message.acceleration, value: size(message.acceleration) }),
      remove: () => this.edit({ conditions: conditions.filter((_, i) => i + 1 !== message.condition) }, `part:remove(${message.condition})`),
      change: () => this.edit({ conditions: conditions.map((c, i) => (i + 1 === message.condition && message.force
        ? { ...c, vector: message.force, value: size(message.force), faces: message.faces } : c)) }, `part:change(${message.condition})`),
      material: () => this.edit({ material: message.name }, `part:material "${message.name}"`),
      lock: () => this.edit({ locked: message.faces }, "part:lock {}"),
      push: () => this.edit({ height: this.now.height + message.distance }, `part:push {faces = {${message.faces}}, distance = ${message.distance}}`),
      radius: () => this.edit({ radius: message.radius }, `part:radius {radius = ${message.radius}}`),
      undo: () => {
        this.future.push(this.now);
        this.now = this.past.pop();
      },
      redo: () => {
        this.past.push(this.now);
        this.now = this.future.pop();
      },
      answer: () => (this.now = { ...this.now, answer: { verdict: "holds", colour: "green",
        sentence: "It holds: 36 % of the strength of PLA (31 to 42 %).", utilisation: 0.36, low: 0.31, high: 0.42, force: 55.6,
        force_low: 47.6, force_high: 64.5, at: [0, this.now.radius, this.now.height], frequency: 812, mass: 0.0293,
        notes: ["Linear elasticity: the part moves little beside its size."], elements: 18231, seconds: 2.4, max_displacement: 2e-5 } }),
      advice: () => (this.advice = [{ text: "Thicken the upper face by 0.8 mm", faces: [1], gain: 0.22 },
        { text: "Make the hole 1 mm smaller in radius", faces: [7], gain: 0.11 }]),
      apply: () => this.edit({ height: this.now.height + 0.0008 }, `part:apply(${message.advice})`),
      save: () => (this.saved = "plate.workbench.lua"),
      export: () => socket.send(JSON.stringify({ type: "file", id: message.id, url: `plate.${message.format}`, name: `plate.${message.format}` })),
      probe: () => socket.send(JSON.stringify({ type: "probe", id: message.id, point: message.point, von_mises: 1.2e7 })),
    };
    if (message.faces?.some((f) => this.now.locked.includes(f)) && what === "push")
      return socket.send(JSON.stringify({ type: "refused", id: message.id, message: "This face is locked: unlock it first.", details: "face 1" }));
    const { height, radius, answer } = this.now;
    does[what]?.();
    const other = height !== this.now.height || radius !== this.now.radius;
    this.scene += other ? 1 : 0;
    this.tell(message.id, other || answer !== this.now.answer);
  }

  // Serves page and socket to the windows of a browser's context.
  async serve(context, root) {
    const web = (name) => fs.readFileSync(path.join(root, "web", name), "utf8");
    const policy = "default-src 'none'; script-src 'self'; style-src 'unsafe-inline'; img-src 'self' data:; connect-src 'self' ws:";
    await context.route("http://workbench.test/**", (route) => {
      const name = new URL(route.request().url()).pathname.slice(1);
      const headers = { "Content-Security-Policy": policy };
      if (name === "") return route.fulfill({ headers, contentType: "text/html; charset=utf-8",
        body: web("workbench.html").replace("/* workbench.css */", () => web("workbench.css")) });
      if (name === "workbench.js") return route.fulfill({ headers, contentType: "text/javascript; charset=utf-8",
        body: fs.readFileSync(path.join(root, "build/web/workbench.js")) });
      if (name === "upload") {
        this.file = new URL(route.request().url()).searchParams.get("name");
        this.tell(undefined, true);
        return route.fulfill({ headers, body: "" });
      }
      return route.fulfill({ headers: { "Content-Disposition": `attachment; filename="${name}"` }, body: "solid plate" });
    });
    await context.routeWebSocket(/workbench\.test\/socket/, (socket) => {
      this.sockets.add(socket);
      socket.onMessage((text) => (this.delay ? setTimeout(() => this.handle(JSON.parse(text), socket), this.delay)
        : this.handle(JSON.parse(text), socket)));
      socket.onClose(() => this.sockets.delete(socket));
      socket.send(JSON.stringify({ type: "welcome", client: ++this.clients }));
      if (this.file) socket.send(this.picture());
      socket.send(JSON.stringify(this.state()));
    });
    return "http://workbench.test/";
  }
}
