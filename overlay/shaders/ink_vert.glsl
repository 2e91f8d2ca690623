// Flat shapes and text, one instance each: a box turned by `axis`, in pixels of the picture (the centre of
// the top left one is 0, 0).
layout(location = 0) in vec4 a_box;     // centre, half size
layout(location = 1) in vec4 a_shape;   // axis, corner radius, stroke width (0: filled)
layout(location = 2) in vec4 a_color;   // straight alpha
layout(location = 3) in vec4 a_anchor;  // pixel, depth (0: nothing can hide it), what being hidden does
layout(location = 4) in vec4 a_extra;   // first texel, 1 for text, period of the dashes
uniform vec2 u_picture;
uniform vec2 u_clip_depths;
uniform sampler2D u_depth;
out vec2 v_local;
flat out vec4 v_half_radius_stroke;
flat out vec4 v_color;
flat out vec4 v_extra;

// Share of the anchor's surroundings where the surface lies clearly in front of it: hidden is not a matter
// of one pixel, so that it does not flicker.
float hiddenShare() {
  if (a_anchor.z <= 0.0) return 0.0;
  float n = u_clip_depths.x, f = u_clip_depths.y;
  float hidden = 0.0;
  ivec2 top = textureSize(u_depth, 0) - 1;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      ivec2 at = clamp(ivec2(floor(a_anchor.xy + 0.5)) + ivec2(2 * x, 2 * y), ivec2(0), top);
      float d = texelFetch(u_depth, at, 0).r;
      float z = 2.0 * n * f / (f + n - (2.0 * d - 1.0) * (f - n));
      hidden += z < 0.97 * a_anchor.z ? 1.0 : 0.0;
    }
  return smoothstep(0.25, 0.75, hidden / 25.0);
}

void main() {
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  bool text = a_extra.z > 0.5;
  v_local = corner * (a_box.zw + (text ? 0.0 : 1.0));
  vec2 axis = a_shape.xy;
  vec2 px = a_box.xy + v_local.x * axis + v_local.y * vec2(-axis.y, axis.x);
  gl_Position = vec4((px + 0.5) / u_picture * 2.0 - 1.0, 0.0, 1.0);

  float hidden = hiddenShare();
  float visibility = 1.0;
  if (a_anchor.w == 1.0) visibility = mix(1.0, 0.5, hidden);   // dimmed
  else if (a_anchor.w == 2.0) visibility = 1.0 - hidden;       // only in the open
  else if (a_anchor.w == 3.0) visibility = hidden;             // only when hidden
  v_color = vec4(a_color.rgb, a_color.a * visibility);
  v_half_radius_stroke = vec4(a_box.zw, a_shape.zw);
  v_extra = vec4(a_extra.xyz, hidden > 0.5 ? a_extra.w : 0.0);
}
