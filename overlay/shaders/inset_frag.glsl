in float v_depth;
in vec3 v_normal;
in float v_fade;
uniform vec2 u_depth_scale;  // see depthPlace
uniform float u_alpha;
layout(location = 0) out vec4 o_color;  // premultiplied

void main() {
  if (v_fade < 0.15) discard;
  // A lamp above the viewer's left shoulder; the far side of the tissue stays darker.
  vec3 n = normalize(v_normal);
  float lit = max(dot(n, normalize(vec3(-0.35, -0.45, -0.82))), 0.0);
  float lightness = n.z < 0.0 ? 0.35 + 0.65 * lit : 0.25;
  vec3 c = depthColor(depthPlace(v_depth, u_depth_scale));
  o_color = vec4(c * lightness, 1.0) * u_alpha;
}
