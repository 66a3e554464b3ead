// What bodies and marks are made of. Without a graphics card light is worked out at corners alone, and shadows are none:
// for every pixel it would cost more than all else.

import { DoubleSide, LineBasicMaterial, MeshBasicMaterial, MeshLambertMaterial } from "three";
import { across, add, dot, times } from "./geometry.js";

const HATCH = 12; // pixels between the lines of a hatch, about

// Of a body: it leaves out what lies in holes.
export function faceMaterial(look, holes, isSoftware) {
  return made({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, clipShadows: true, ...look }, isSoftware, holes);
}

// Of a body that is seen through: it marks what of it is nearest to the eye.
export function hiddenMaterial(holes) {
  const look = { colorWrite: false, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 };
  const material = new MeshBasicMaterial(look);
  if (holes.count) leaveOut(material, holes);
  return material;
}

// Of the lines around a cut.
export function lineMaterial(color, holes) {
  const material = new LineBasicMaterial({ color });
  if (holes.count) leaveOut(material, holes);
  return material;
}

function leaveOut(material, holes) {
  material.onBeforeCompile = (shader) => cutHoles(shader, holes);
  material.customProgramCacheKey = () => `holes ${holes.count}`;
}

// Of a cut: the colour of its body, with lines at an angle; `slant` is 1 or -1. Where cuts lie on each other, that with the
// higher rank is seen.
export function capMaterial({ face, edge, slant }, rank, holes) {
  const material = new MeshBasicMaterial({ color: face, side: DoubleSide, fog: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 8 - 4 * rank });
  const uniforms = { hatchWay: { value: [0, 0, 0] }, hatchStart: { value: 0 }, hatchColor: { value: edge } };
  material.onBeforeCompile = (shader) => {
    if (holes.count) cutHoles(shader, holes);
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader.replace("#include <common>", "#include <common>\nuniform vec3 hatchWay;\nvarying float vHatch;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvHatch = dot(hatchWay, (modelMatrix * vec4(position, 1.0)).xyz);");
    shader.fragmentShader = shader.fragmentShader.replace("#include <common>", "#include <common>\nuniform float hatchStart;\nuniform vec3 hatchColor;\nvarying float vHatch;")
      .replace("#include <color_fragment>", `#include <color_fragment>
        float hatched = vHatch + hatchStart, wide = fwidth(vHatch);
        float apart = abs(fract(hatched) - 0.5) / max(wide, 1e-9);
        diffuseColor.rgb = mix(hatchColor, diffuseColor.rgb, clamp(apart, 0.45, 1.0));`);
  };
  material.customProgramCacheKey = () => `cap, holes ${holes.count}`;
  // As far apart as suits the picture, in steps, and fixed to the scene: else they would swim as one zooms and moves.
  material.hatch = ({ normal }, camera) => {
    const [one, other] = across(normal);
    const step = 2 ** Math.round(Math.log2(HATCH * camera.pixel()));
    const way = times(Math.SQRT1_2 / step, add(one, times(slant, other)));
    const start = dot(way, camera.target);
    uniforms.hatchWay.value = way;
    uniforms.hatchStart.value = start - Math.floor(start);
  };
  return material;
}

// Of marks, each of which has a colour of its own.
export function markMaterial(look, isSoftware) {
  return made({ vertexColors: true, ...look }, isSoftware, { count: 0 });
}

function made(look, isSoftware, holes) {
  const material = new MeshLambertMaterial(look);
  if (!holes.count && !isSoftware) return material;
  material.onBeforeCompile = (shader) => {
    if (isSoftware) lightCorners(shader);
    if (holes.count) cutHoles(shader, holes);
  };
  material.customProgramCacheKey = () => `holes ${holes.count}, software ${isSoftware}`;
  return material;
}

// As look.py's `lit`, and the same lights. They are no loop when it runs: that took longer than all else together.
function lightCorners(shader) {
  shader.vertexShader = shader.vertexShader.replace("#include <common>", `#include <common>
    #include <lights_pars_begin>
    uniform vec3 diffuse;
    varying vec3 vLit;`)
    .replace("#include <defaultnormal_vertex>", `#include <defaultnormal_vertex>
    vec3 normal_ = normalize(transformedNormal);
    vec3 light = mix(hemisphereLights[0].groundColor, hemisphereLights[0].skyColor, 0.5 + 0.5 * dot(normal_, hemisphereLights[0].direction));
    #pragma unroll_loop_start
    for (int i = 0; i < NUM_DIR_LIGHTS; i++) {
      light += directionalLights[ i ].color * max(0.0, dot(normal_, directionalLights[ i ].direction));
    }
    #pragma unroll_loop_end
    #ifdef USE_COLOR
      light *= color;
    #endif
    vec3 linear = min(diffuse * light * RECIPROCAL_PI, 1.0);
    vLit = mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));`);
  shader.fragmentShader = `#include <common>
    #include <fog_pars_fragment>
    #include <clipping_planes_pars_fragment>
    uniform float opacity;
    varying vec3 vLit;
    void main() {
      #include <clipping_planes_fragment>
      gl_FragColor = vec4(vLit, opacity);
      #include <fog_fragment>
    }`;
}

// Each hole is told about the target: the square of the distance from its axis is a number there, a slope and a square, so
// that its wall is sharp at any zoom. Nothing is branched on but once: in software each branch costs as much as a hole.
function cutHoles(shader, holes) {
  Object.assign(shader.uniforms, holes.uniforms);
  shader.vertexShader = shader.vertexShader.replace("#include <common>", "#include <common>\nvarying vec3 vPlace;")
    .replace("#include <begin_vertex>", "#include <begin_vertex>\nvPlace = (modelMatrix * vec4(position, 1.0)).xyz;");
  shader.fragmentShader = shader.fragmentShader.replace("#include <common>", `#include <common>
    varying vec3 vPlace;
    uniform mat3 holeTurns[${holes.count}];
    uniform vec4 holeAxes[${holes.count}];
    uniform vec4 holeSizes[${holes.count}];
    float isIn(mat3 turn, vec4 axis, vec4 size) {
      vec3 place = turn * vPlace;
      float height = axis.w + place.z;
      float beyond = axis.x + dot(axis.yz, place.xy) + dot(place.xy, place.xy);
      float widened = max(0.0, height + size.z) * size.w;
      return step(size.x, height) * step(height, size.y) * (1.0 - step(widened, beyond));
    }`)
    .replace("#include <clipping_planes_fragment>", `#include <clipping_planes_fragment>
    float cut = 0.0;
    ${holes.holes.map((_, i) => `cut += isIn(holeTurns[${i}], holeAxes[${i}], holeSizes[${i}]);`).join("\n    ")}
    if (cut > 0.0) discard;`);
}
