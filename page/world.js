// Light, shadow, ground: what makes a picture of bodies one of a place.

import { BufferAttribute, BufferGeometry, DirectionalLight, Fog, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, PCFShadowMap,
  PlaneGeometry, Scene, ShadowMaterial, WebGLRenderer } from "three";
import { sub } from "./geometry.js";
import { color } from "./marks.js";

const SOFTWARE = /swiftshader|llvmpipe|software|basic render/i; // there, shadows and smooth edges would cost more than all else
const SLOW_MS = 45, SLOW_IN_A_ROW = 6; // under 22 pictures a second

function graphicsCard() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) throw new Error("this browser has no WebGL 2");
  const asked = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(asked ? asked.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

export class World {
  constructor(canvas, data) {
    this.data = data;
    const { paper, paint, sky, ground, sun, lamp } = data.look;
    const isSoftware = this.isSoftware = SOFTWARE.test(graphicsCard());
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware, preserveDrawingBuffer: true });
    this.renderer.setClearColor(color(paper));
    this.renderer.localClippingEnabled = true;
    this.scene = new Scene();
    this.scene.fog = new Fog(color(paper));
    this.sun = new DirectionalLight(0xffffff, sun);
    this.lamp = new DirectionalLight(0xffffff, lamp); // beside the viewer
    const around = new HemisphereLight(color("#ffffff"), color(ground), sky);
    around.position.set(0, 0, 1);
    this.scene.add(around, this.sun, this.sun.target, this.lamp, this.lamp.target);
    this.hasShadows = !isSoftware;
    if (this.hasShadows) this.castShadows();
    this.grid = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: color(paint.grid) }));
    this.grid.frustumCulled = false;
    this.scene.add(this.grid);
  }

  castShadows() {
    this.renderer.shadowMap.enabled = this.sun.castShadow = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 4;
    this.sun.shadow.normalBias = 0.002;
    const reach = 1.3 * this.data.radius;
    Object.assign(this.sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: 8 * this.data.radius });
    this.floor = new Mesh(new PlaneGeometry(12 * this.data.radius, 12 * this.data.radius), new ShadowMaterial({ opacity: 0.16, depthWrite: false }));
    this.floor.receiveShadow = true;
    this.scene.add(this.floor);
  }

  // Called for each of a row of pictures, with the time since the one before: where they come too slowly, shadows go.
  paced(passed) {
    this.slow = passed > SLOW_MS ? (this.slow ?? 0) + 1 : 0;
    if (this.slow < SLOW_IN_A_ROW || !this.hasShadows) return;
    this.hasShadows = false;
    this.scene.remove(this.floor);
    this.floor = null;
  }

  // A grid of round lengths on the ground, which lies at a height.
  layGround(height) {
    const { unitsPerDrawing, radius, look: { grid_lines: count } } = this.data;
    const rough = 2 * radius * unitsPerDrawing / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((times) => times * power >= rough) / unitsPerDrawing;
    const end = count * step;
    const lines = [];
    for (let i = -count; i <= count; i++) lines.push(i * step, -end, 0, i * step, end, 0, -end, i * step, 0, end, i * step, 0);
    this.grid.geometry.setAttribute("position", new BufferAttribute(new Float32Array(lines), 3));
    this.ground = height;
  }

  // As a camera sees it, and in a corner as an inset does, if that is shown.
  draw(camera, overlayScale, inset) {
    const [width, height] = camera.size();
    if (this.width !== width || this.height !== height || this.scale !== overlayScale) { // each of both makes the picture's memory anew
      this.renderer.setPixelRatio(overlayScale);
      this.renderer.setSize(width, height, false);
    }
    Object.assign(this, { width, height, scale: overlayScale });
    const origin = sub([0, 0, 0], camera.target);
    const isClose = camera.isClose();
    this.grid.visible = !isClose;
    this.grid.position.set(origin[0], origin[1], origin[2] + this.ground);
    if (this.floor) {
      this.floor.visible = !isClose;
      this.floor.position.copy(this.grid.position);
    }
    this.sun.castShadow = this.hasShadows && !isClose;
    this.sun.target.position.set(...origin);
    this.sun.position.set(...this.data.look.sun_from.map((value, i) => origin[i] + 3 * this.data.radius * value));
    const [right, up, back] = camera.axes(), lamp = this.data.look.lamp_from;
    this.lamp.position.set(...[0, 1, 2].map((i) => lamp[0] * right[i] + lamp[1] * up[i] + lamp[2] * back[i]));
    this.layFog(camera);
    this.renderer.render(this.scene, camera.three());
    if (inset.isShown) this.drawInset(inset, camera);
  }

  layFog(eye) {
    const isClose = eye.isClose(), depth = isClose ? eye.reach() : 3 * this.data.radius;
    const nearest = eye.distance() - 0.3 * depth;
    this.scene.fog.near = nearest;
    this.scene.fog.far = nearest + (isClose ? 1.5 : 3) * depth;
  }

  drawInset({ eye, corner: [left, top] }, camera) {
    const { renderer } = this, [width, height] = eye.size(), below = this.height - top - height;
    this.grid.visible = false;
    renderer.shadowMap.autoUpdate = false;
    this.layFog(eye);
    renderer.setScissorTest(true);
    renderer.setScissor(left, below, width, height);
    renderer.setViewport(left, below, width, height);
    renderer.render(this.scene, eye.three(camera.target));
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, this.width, this.height);
    renderer.shadowMap.autoUpdate = true;
  }
}
