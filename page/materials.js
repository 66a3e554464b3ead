// What bodies and marks are made of. Without a graphics card light is worked out at corners alone, and shadows are none:
// for every pixel it would cost more than all else.

import { MeshLambertMaterial } from "three";

// Of a body: it leaves out what lies in holes.
export function faceMaterial(look, holes, isSoftware) {
  return made({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...look }, isSoftware, holes);
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
