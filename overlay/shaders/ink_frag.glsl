in vec2 v_local;
flat in vec4 v_half_radius_stroke;
flat in vec4 v_color;
flat in vec4 v_extra;
uniform sampler2D u_text;   // r: glyphs, g: their dark surround
uniform float u_alpha;
layout(location = 0) out vec4 o_color;  // premultiplied

void main() {
  vec2 half_size = v_half_radius_stroke.xy;
  if (v_extra.z > 0.5) {
    ivec2 texel = ivec2(v_extra.xy + floor(v_local + half_size));
    vec2 g = texelFetch(u_text, texel, 0).rg * v_color.a * u_alpha;
    float surround = (1.0 - g.r) * g.g * 0.75;
    o_color = vec4(v_color.rgb * g.r, g.r + surround);
    return;
  }
  float radius = v_half_radius_stroke.z, stroke = v_half_radius_stroke.w;
  vec2 q = abs(v_local) - half_size + radius;
  float distance = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - radius;
  if (stroke > 0.0) distance = abs(distance + 0.5 * stroke) - 0.5 * stroke;
  float coverage = clamp(0.5 - distance, 0.0, 1.0);
  if (v_extra.w > 0.0) {
    float s = abs(fract((v_local.x + half_size.x) / v_extra.w) - 0.5) * v_extra.w;
    coverage *= clamp(s - 0.2 * v_extra.w + 0.5, 0.0, 1.0);
  }
  float a = coverage * v_color.a * u_alpha;
  o_color = vec4(v_color.rgb * a, a);
}
