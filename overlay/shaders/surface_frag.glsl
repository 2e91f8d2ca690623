// Built twice: with CUE_MESH for the paper's transparent mesh, without for pseudo-chromadepth.
#ifdef CUE_MESH
in vec3 v_bary;
#endif
in float v_fade;
uniform vec2 u_depth_scale;  // see depthPlace
uniform vec2 u_contour;      // 1 / distance of the contour lines, strength of every second one
uniform float u_opacity;     // of the cue
uniform float u_alpha;       // of everything
layout(location = 0) out vec4 o_color;  // premultiplied

#ifdef CUE_MESH
vec4 cue(float t, float depth) {
  vec3 slope = fwidth(v_bary);
  vec3 edges = v_bary / max(slope, vec3(1e-6));
  float line = 1.0 - smoothstep(0.2, 1.2, min(edges.x, min(edges.y, edges.z)));
  // Triangles of a few pixels would be nothing but lines: these turn into an even tint instead.
  float density = max(slope.x, max(slope.y, slope.z));
  line *= 1.0 - smoothstep(0.08, 0.5, density);
  vec3 light = mix(vec3(0.90, 1.0, 0.97), vec3(0.16, 0.52, 0.72), clamp(t, 0.0, 1.0));
  float a = u_opacity * (0.35 + 1.2 * line);
  return vec4(light, min(a, 1.0));
}
#else
vec4 cue(float t, float depth) {
  float c = depth * u_contour.x;
  float width = max(abs(dFdx(c)) + abs(dFdy(c)), 1e-6);
  float nearest = floor(c + 0.5);
  float line = clamp(1.1 - abs(c - nearest) / width, 0.0, 1.0);
  line *= clamp(1.6 - 4.0 * width, 0.0, 1.0);              // too steep to tell lines apart
  line *= mix(1.0, u_contour.y, 2.0 * fract(0.5 * nearest));  // every second one
  return vec4(mix(depthColor(t), vec3(1.0), 0.55 * line), u_opacity + (1.0 - u_opacity) * 0.35 * line);
}
#endif

void main() {
  float fade = min(v_fade, 1.0) * inView();
  if (fade <= 0.0) discard;
  // 1 / w is 1 / depth, and there already.
  vec4 c = cue(inverseDepthPlace(gl_FragCoord.w, u_depth_scale), 1.0 / gl_FragCoord.w);
  float a = c.a * fade * u_alpha;
  o_color = vec4(c.rgb * a, a);
}
