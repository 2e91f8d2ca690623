// Built twice: with CUE_MESH for the paper's transparent mesh, without for pseudo-chromadepth.
#ifdef CUE_MESH
in vec3 v_bary;
#endif
in float v_fade;
in float v_depth;
uniform vec2 u_depth_scale;  // see depthPlace
uniform vec2 u_contour;      // 1 / distance of the contour lines, strength of every second one
uniform float u_opacity;     // of the cue
uniform float u_alpha;       // of everything
layout(location = 0) out vec4 o_color;  // premultiplied

#ifdef CUE_MESH
vec4 cue(float t) {
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
vec4 cue(float t) {
  float c = v_depth * u_contour.x;
  float nearest = floor(c + 0.5);
  float width = max(fwidth(c), 1e-6);
  float line = clamp(1.1 - abs(c - nearest) / width, 0.0, 1.0);
  line *= 1.0 - smoothstep(0.15, 0.4, width);   // too steep to tell lines apart
  bool fine = mod(nearest, 2.0) > 0.5;
  line *= fine ? u_contour.y : 1.0;
  vec3 color = depthColor(t);
  return vec4(mix(color, vec3(1.0), 0.55 * line), u_opacity + (1.0 - u_opacity) * 0.35 * line);
}
#endif

void main() {
  vec4 c = cue(depthPlace(v_depth, u_depth_scale));
  if (v_fade <= 0.0) discard;
  float a = c.a * v_fade * u_alpha;
  o_color = vec4(c.rgb * a, a);
}
