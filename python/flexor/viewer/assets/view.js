"use strict";
// The view in three dimensions: one design, or two side by side with the same camera.

Flexor.View = class {
  constructor(host, describe) {
    const { h } = Flexor;
    this.host = host;
    this.groups = [];
    this.step = 0;
    this.field = null;
    this.seeThrough = false;
    this.canvas = h("canvas", {
      tabindex: "0",
      role: "img",
      "aria-label": describe,
      "aria-keyshortcuts": "ArrowLeft ArrowRight ArrowUp ArrowDown + -",
    });
    host.append(this.canvas);
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true });
    } catch {
      this.canvas.remove();
      host.append(
        h("p", { role: "alert", class: "no3d" }, "This browser shows no WebGL: the view in three dimensions is missing, plots and table are complete."),
      );
      return;
    }
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.001, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(host);
  }

  // Replace what is shown; `arrays` is the map of decoded arrays.
  show(designs, arrays, keepCamera = false) {
    if (!this.renderer) return;
    const before = this.groups;
    this.arrays = arrays;
    this.groups = designs.map((design) => this.build(design));
    // After the new ones, which use the same programs of the graphics card.
    for (const group of before) {
      group.scene.traverse((each) => {
        if (each.geometry) each.geometry.dispose();
        if (each.material) each.material.dispose();
      });
    }
    this.low = new THREE.Vector3(Infinity, Infinity, Infinity);
    this.high = new THREE.Vector3(-Infinity, -Infinity, -Infinity);
    for (const { scene } of designs) {
      this.low.min(new THREE.Vector3(...scene.low));
      this.high.max(new THREE.Vector3(...scene.high));
    }
    this.setStep(this.step);
    if (!keepCamera) this.look("oblique");
    this.resize();
  }

  build(design) {
    const scene = new THREE.Scene();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 2.2));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.4);
    lamp.position.set(-0.6, -1, 1.6);
    scene.add(lamp);
    const parts = [...new Set(design.scene.objects.filter((o) => o.kind === "rod").map((o) => o.part))];
    const meshes = design.scene.objects.map((object) => {
      const geometry = new THREE.BufferGeometry();
      const positions = object.local ? this.arrays.get(object.local).slice() : new Float32Array(3 * object.size);
      geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * object.size), 3));
      geometry.setIndex(new THREE.BufferAttribute(this.arrays.get(object.faces), 1));
      const material = new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide });
      if (object.kind === "chamber") {
        // Behind the wall that it touches.
        Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
      }
      // Marks are within what touches, and are seen through it.
      const mark = object.kind === "friction";
      if (mark) Object.assign(material, { side: THREE.FrontSide, depthTest: false });
      const mesh = new THREE.Mesh(geometry, material);
      if (mark) mesh.renderOrder = 1;
      mesh.frustumCulled = false;
      const base = object.kind === "rod"
        ? Flexor.colours.rod[parts.indexOf(object.part) % Flexor.colours.rod.length]
        : Flexor.colours[object.part] || Flexor.colours[object.kind];
      const rigid = object.local && object.count === 1;
      if (rigid) {
        mesh.matrixAutoUpdate = false;
        geometry.computeVertexNormals();
      }
      scene.add(mesh);
      return { object, mesh, rigid, base: new THREE.Color(base) };
    });
    return { scene, meshes, design };
  }

  setStep(step) {
    this.step = step;
    if (!this.renderer) return;
    for (const { meshes, design } of this.groups) {
      const at = Math.min(step, design.scene.steps - 1);
      for (const each of meshes) {
        this.move(each, at);
        this.paint(each, design, at);
      }
    }
    this.draw();
  }

  move({ object, mesh, rigid }, step) {
    const position = mesh.geometry.attributes.position;
    if (!object.local) {
      const all = this.arrays.get(object.positions);
      position.array.set(all.subarray(3 * object.size * step, 3 * object.size * (step + 1)));
    } else {
      const frames = this.arrays.get(object.frames);
      const first = 12 * object.count * step;
      if (rigid) {
        mesh.matrix.set(...frames.subarray(first, first + 12), 0, 0, 0, 1);
        mesh.matrixWorldNeedsUpdate = true;
        return;
      }
      const local = this.arrays.get(object.local);
      const frame = this.arrays.get(object.frame);
      for (let i = 0; i < object.size; i++) {
        const f = first + 12 * frame[i];
        const x = local[3 * i], y = local[3 * i + 1], z = local[3 * i + 2];
        for (let k = 0; k < 3; k++) {
          const r = f + 4 * k;
          position.array[3 * i + k] =
            frames[r] * x + frames[r + 1] * y + frames[r + 2] * z + frames[r + 3];
        }
      }
    }
    position.needsUpdate = true;
    mesh.geometry.computeVertexNormals();
  }

  paint({ object, mesh, base }, design, step) {
    const colour = mesh.geometry.attributes.color;
    const key = this.field && object.fields[this.field];
    const scale = this.field && design.scene.scales[this.field];
    const common = this.scale();
    const solid = ["link", "rod"].includes(object.kind);
    // A field is seen best on neutral surfaces.
    const plain = this.field && solid ? new THREE.Color("#d3d7db") : base;
    if (key) {
      const table = this.arrays.get(scale.colours);
      const codes = this.arrays.get(key).subarray(object.size * step, object.size * (step + 1));
      // From the colours of this design's scale to those of the common one.
      const last = table.length / 3 - 1;
      const index = Array.from({ length: last + 1 }, (_, code) => {
        const value = scale.low + (code / last) * (scale.high - scale.low);
        return Math.round((last * (value - common.low)) / (common.high - common.low));
      });
      for (let i = 0; i < object.size; i++) {
        const none = codes[i] === 255;
        const c = none ? 0 : 3 * index[codes[i]];
        colour.array[3 * i] = none ? plain.r : Flexor.linear(table[c]);
        colour.array[3 * i + 1] = none ? plain.g : Flexor.linear(table[c + 1]);
        colour.array[3 * i + 2] = none ? plain.b : Flexor.linear(table[c + 2]);
      }
    } else {
      for (let i = 0; i < object.size; i++) plain.toArray(colour.array, 3 * i);
    }
    colour.needsUpdate = true;
    const material = mesh.material;
    const device = ["rod", "strap"].includes(object.kind);
    // The skin is touched below the device, which hides it.
    const covers = this.field === "contact-pressure" && (device || object.kind === "chamber");
    mesh.visible = !(covers && object.kind === "chamber");
    const through = covers || (this.seeThrough && (device || (object.part === "skin" && !key)));
    material.opacity = object.kind === "obstacle" ? 0.45 : covers ? 0.15 : through ? 0.3 : 1;
    // The graphics card draws what is transparent last.
    const transparent = material.opacity < 1 || object.kind === "friction";
    if (material.transparent !== transparent) material.needsUpdate = true;
    material.transparent = transparent;
    material.depthWrite = !transparent;
  }

  // The scale of the field for all designs that are shown, or null.
  scale() {
    const each = this.groups.map(({ design }) => design.scene.scales[this.field]).filter(Boolean);
    if (!each.length) return null;
    return { ...each[0], low: Math.min(...each.map((s) => s.low)), high: Math.max(...each.map((s) => s.high)) };
  }

  setField(field) {
    this.field = field;
    this.setStep(this.step);
  }

  setSeeThrough(on) {
    this.seeThrough = on;
    this.setStep(this.step);
  }

  // Look from a side at all of it.
  look(from) {
    if (!this.renderer || !this.groups.length) return;
    const centre = this.low.clone().add(this.high).multiplyScalar(0.5);
    const directions = { side: [0, -1, 0.02], top: [0, -0.02, 1], front: [1, -0.02, 0.02], oblique: [-0.35, -1, 0.45] };
    const direction = new THREE.Vector3(...directions[from]).normalize();
    const right = new THREE.Vector3(0, 0, 1).cross(direction).normalize();
    const up = direction.clone().cross(right);
    const columns = Math.max(1, this.groups.length);
    const aspect = Math.max(0.2, this.host.clientWidth / columns / Math.max(1, this.host.clientHeight));
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    // So far away that every corner of the box is in the picture.
    let distance = 0.01;
    for (let corner = 0; corner < 8; corner++) {
      const ends = [this.low, this.high];
      const at = new THREE.Vector3(ends[corner & 1].x, ends[(corner >> 1) & 1].y, ends[corner >> 2].z).sub(centre);
      const reach = Math.max(Math.abs(at.dot(up)), Math.abs(at.dot(right)) / aspect);
      distance = Math.max(distance, (1.08 * reach) / slope + at.dot(direction));
    }
    this.camera.near = 0.01 * distance;
    this.camera.far = 20 * distance;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.controls.update();
    this.draw();
  }

  key(event) {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (event.key in turns) {
      const [around, up] = turns[event.key];
      const spherical = new THREE.Spherical().setFromVector3(new THREE.Vector3(offset.x, offset.z, -offset.y));
      spherical.theta += 0.12 * around;
      spherical.phi = Math.min(Math.PI - 0.02, Math.max(0.02, spherical.phi + 0.12 * up));
      const turned = new THREE.Vector3().setFromSpherical(spherical);
      offset.set(turned.x, -turned.z, turned.y);
    } else if (event.key === "+" || event.key === "=") offset.multiplyScalar(0.9);
    else if (event.key === "-") offset.multiplyScalar(1.1);
    else return;
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  resize() {
    if (!this.renderer) return;
    const width = Math.max(1, this.host.clientWidth), height = Math.max(1, this.host.clientHeight);
    this.renderer.setSize(width, height, false);
    this.draw();
  }

  draw() {
    if (this.pending || !this.renderer) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.render();
    });
  }

  render() {
    const count = this.groups.length;
    if (!count) return;
    const width = this.host.clientWidth, height = this.host.clientHeight;
    this.renderer.setScissorTest(count > 1);
    this.camera.aspect = width / count / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    this.groups.forEach(({ scene }, i) => {
      const left = Math.round((i * width) / count), right = Math.round(((i + 1) * width) / count);
      this.renderer.setViewport(left, 0, right - left, height);
      this.renderer.setScissor(left, 0, right - left, height);
      this.renderer.render(scene, this.camera);
    });
  }

  // The picture as PNG, on a white background.
  async png() {
    this.render();
    const copy = document.createElement("canvas");
    copy.width = this.canvas.width;
    copy.height = this.canvas.height;
    const context = copy.getContext("2d");
    context.fillStyle = "white";
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(this.canvas, 0, 0);
    return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
  }
};
