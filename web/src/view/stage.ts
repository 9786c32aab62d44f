// SPDX-License-Identifier: Apache-2.0
// Renderer, lights and ground: one low key light, a weak fill light, light all around, light from
// the camera where these leave a side dark, and a millimeter grid under
// the block. World units are mm, Z is up.

import * as THREE from 'three';
import type { Bounds } from '../model/session';
import { ambientLight } from './ambient_light';
import { shadowOnGround } from './ground_shadow';
import { shadowSample } from './shader_samples';
import { adaptShadows } from './soft_shadows';

const GRID_VERTEX = /* glsl */ `
varying vec3 vWorld;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const GRID_FRAGMENT = /* glsl */ `
varying vec3 vWorld;
uniform vec2 center;
uniform float reach;
uniform float step;
uniform vec2 footMin;
uniform vec2 footMax;
float lines(float spacing, vec2 pixel) {
  vec2 at = vWorld.xy / spacing;
  vec2 width = pixel / spacing;
  vec2 line = 1.0 - smoothstep(vec2(0.0), width * 1.2, abs(fract(at - 0.5) - 0.5));
  return max(line.x, line.y) * (1.0 - smoothstep(0.25, 0.6, max(width.x, width.y)));
}
void main() {
  float fade = 1.0 - smoothstep(0.25 * reach, reach, distance(vWorld.xy, center));
  vec2 pixel = fwidth(vWorld.xy);
  float ink = max(0.20 * lines(step, pixel), 0.42 * lines(step * 10.0, pixel));
  ink *= fade * fade;
  // A soft contact shadow around the block's foot.
  vec2 beside = max(max(footMin - vWorld.xy, vWorld.xy - footMax), vec2(0.0));
  float near = exp(-length(beside) / (0.035 * reach));
  float wide = exp(-length(beside) / (0.12 * reach));
  float rim = 0.34 * near + 0.10 * wide;
  float alpha = 1.0 - (1.0 - ink) * (1.0 - rim);
  vec3 color = mix(vec3(0.44, 0.53, 0.64), vec3(0.19, 0.23, 0.29), rim / max(alpha, 1e-4));
  gl_FragColor = vec4(color, alpha);
}`;

const UP = new THREE.Vector3(0, 0, 1);
const FACING_LIGHT = 0.65;
const SHADOW_RADIUS = 7; // texels of the shadow map

/** True if the CPU draws WebGL instead of a GPU (remote desktops, virtual machines). */
export function drawsInSoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Stage {
  readonly scene = new THREE.Scene();
  readonly renderer: THREE.WebGLRenderer;
  private readonly key_ = new THREE.DirectionalLight('#fff0dc', 4.1);
  private readonly fill_ = new THREE.DirectionalLight('#e6eeff', 1.15);
  private readonly head_ = new THREE.DirectionalLight('#f4f4ff', 0);
  private readonly ambient_ = ambientLight(0.26);
  private readonly center_ = new THREE.Vector3();
  private readonly facing_ = new THREE.Vector3();
  private readonly ground_ = new THREE.Mesh(
    new THREE.PlaneGeometry(1, 1),
    new THREE.ShadowMaterial({ opacity: 0.13 }),
  );
  private readonly gridMaterial_ = new THREE.ShaderMaterial({
    vertexShader: GRID_VERTEX,
    fragmentShader: GRID_FRAGMENT,
    uniforms: {
      center: { value: new THREE.Vector2() },
      reach: { value: 1 },
      step: { value: 10 },
      footMin: { value: new THREE.Vector2() },
      footMax: { value: new THREE.Vector2() },
    },
    transparent: true,
    depthWrite: false,
  });
  private readonly grid_ = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), this.gridMaterial_);

  private readonly groundArea_ = new THREE.Box2(new THREE.Vector2(), new THREE.Vector2());
  private readonly blockShadow_ = this.groundArea_.clone();

  /** Objects that keep their programs: three.js deletes one whose last material is gone. */
  private readonly samples_: THREE.Object3D[] = [];
  private size_ = '';

  /**
   * @param smooth whether edges are smooth: four samples a pixel, which take the CPU much longer
   * @throws Error if WebGL 2 is not available
   */
  constructor(
    canvas: HTMLCanvasElement,
    readonly drawsInSoftware: boolean,
    smooth: boolean,
  ) {
    this.renderer = new THREE.WebGLRenderer({
      canvas,
      antialias: smooth,
      alpha: true,
      stencil: true, // for the caps of sections
      powerPreference: 'high-performance',
    });
    // The check would wait for the shader compiler.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    this.renderer.localClippingEnabled = true;
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.0;
    adaptShadows();
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.addLight_();
    this.grid_.renderOrder = -1;
    this.ground_.receiveShadow = true;
    this.scene.add(this.ground_, this.grid_);
  }

  get gl(): WebGL2RenderingContext {
    return this.renderer.getContext() as WebGL2RenderingContext;
  }

  private addLight_(): void {
    this.key_.castShadow = true;
    this.key_.shadow.mapSize.set(2048, 2048);
    this.isQuick = false;
    this.scene.add(this.ambient_);
    for (const light of [this.key_, this.fill_, this.head_]) this.scene.add(light, light.target);
  }

  /**
   * Gives a face towards the camera at least FACING_LIGHT of the light that a horizontal one has:
   * sides and bottom are not in the dark, and the default view keeps its shading.
   */
  private lightFacing_(eye: THREE.Vector3): void {
    this.facing_.copy(eye).sub(this.center_).normalize();
    const missing = FACING_LIGHT * this.irradiance_(UP) - this.irradiance_(this.facing_);
    this.head_.intensity = Math.max(0, missing);
    this.head_.position.copy(this.center_).add(this.facing_);
  }

  /** Light on a face of this normal, without shadows and the light from the camera. */
  private irradiance_(normal: THREE.Vector3): number {
    const around = this.ambient_.sh.getIrradianceAt(normal, new THREE.Vector3()).x;
    let sum = this.ambient_.intensity * Math.max(0, around);
    for (const { position, target, intensity } of [this.key_, this.fill_]) {
      const towards = position.clone().sub(target.position).normalize();
      sum += intensity * Math.max(0, towards.dot(normal));
    }
    return sum;
  }

  /** Fits lights, shadows and ground to the block. */
  setBounds(bounds: Bounds, pitchMm: number): void {
    const min = new THREE.Vector3(...bounds.min);
    const max = new THREE.Vector3(...bounds.max);
    const center = min.clone().add(max).multiplyScalar(0.5);
    const diagonal = min.distanceTo(max);
    const shadow = this.key_.shadow;
    // The key light grazes the top from behind and to the left of the default camera, so that
    // shading brings out a low relief. The fill light comes from the camera's side and keeps the
    // faces towards the camera from being black.
    this.key_.position
      .copy(center)
      .add(new THREE.Vector3(-1.0, 0.52, 0.74).multiplyScalar(diagonal));
    this.key_.target.position.copy(center);
    this.fill_.position
      .copy(center)
      .add(new THREE.Vector3(0.7, -1.2, 0.55).multiplyScalar(diagonal));
    this.fill_.target.position.copy(center);
    this.head_.target.position.copy(center);
    this.center_.copy(center);
    const half = 0.72 * diagonal;
    Object.assign(shadow.camera, {
      left: -half,
      right: half,
      top: half,
      bottom: -half,
      near: 0.1 * diagonal,
      far: 3.2 * diagonal,
    });
    shadow.camera.updateProjectionMatrix();
    shadow.normalBias = Math.max(0.6 * pitchMm, diagonal / 900);
    shadow.bias = -0.0004;
    const reach = 2.1 * diagonal;
    const groundZ = min.z - 0.0005 * diagonal;
    this.groundArea_.setFromCenterAndSize(
      new THREE.Vector2(center.x, center.y),
      new THREE.Vector2(2 * reach, 2 * reach),
    );
    const light = this.key_.position.clone().sub(center);
    this.blockShadow_.copy(shadowOnGround(new THREE.Box3(min, max), light, groundZ));
    this.ground_.position.setZ(groundZ);
    this.isQuick = false;
    this.grid_.position.set(center.x, center.y, groundZ);
    this.grid_.scale.set(2 * reach, 2 * reach, 1);
    const { uniforms } = this.gridMaterial_;
    Object.assign(uniforms, {
      center: { value: new THREE.Vector2(center.x, center.y) },
      reach: { value: reach },
      step: { value: diagonal > 40 ? 10 : 1 },
      footMin: { value: new THREE.Vector2(min.x, min.y) },
      footMax: { value: new THREE.Vector2(max.x, max.y) },
    });
  }

  set gridVisible(visible: boolean) {
    this.grid_.visible = visible;
  }

  get gridVisible(): boolean {
    return this.grid_.visible;
  }

  /**
   * Whether the picture is drawn quickly, for a CPU: edges of shadows are hard, and the ground has no
   * shadow but the block's, because each pixel that may have one takes a CPU's time.
   */
  set isQuick(quick: boolean) {
    this.key_.shadow.radius = quick ? 0 : SHADOW_RADIUS;
    const { min, max } = quick ? this.blockShadow_ : this.groundArea_;
    this.ground_.position.setX((min.x + max.x) / 2).setY((min.y + max.y) / 2);
    this.ground_.scale.set(max.x - min.x, max.y - min.y, 1);
  }

  /** Does nothing if the size is unchanged, because setting a canvas' size clears it. */
  setSize(width: number, height: number, pixelRatio: number): void {
    const size = `${width}x${height}@${pixelRatio}`;
    if (size === this.size_) return;
    this.size_ = size;
    this.renderer.setDrawingBufferSize(width, height, pixelRatio);
  }

  /**
   * Resolves when the shaders of this stage and of objects like those that are to be in it are ready,
   * with those of their shadows. Keeps these objects.
   */
  async compile(objects: THREE.Object3D, camera: THREE.Camera): Promise<void> {
    const shadows = shadowSample(objects);
    this.samples_.push(objects, shadows);
    const ready = [this.scene, objects].map((part) =>
      this.renderer.compileAsync(part, camera, this.scene),
    );
    // Objects drawn into a texture have programs of their own.
    const texture = new THREE.WebGLRenderTarget(1, 1);
    this.renderer.setRenderTarget(texture);
    ready.push(this.renderer.compileAsync(shadows, camera, this.scene));
    this.renderer.setRenderTarget(null);
    await Promise.all(ready);
    texture.dispose();
    // Asked at the first drawing, these answers would come after all that the GPU has to do then.
    for (const program of this.renderer.info.programs ?? []) {
      program.getUniforms();
      program.getAttributes();
    }
  }

  /** `eye`: where the camera is in the scene, mm. */
  render(camera: THREE.Camera, withShadows: boolean, eye = camera.position): void {
    this.lightFacing_(eye);
    if (withShadows) this.renderer.shadowMap.needsUpdate = true;
    this.renderer.render(this.scene, camera);
  }
}
