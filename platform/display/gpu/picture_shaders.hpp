#pragma once

namespace depthscope::platform::shader_text {

inline constexpr char picture_vert[] = R"glsl(
// One triangle over the whole viewport.
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(corner * 4.0 - 1.0, 0.0, 1.0);
}
)glsl";

// The arithmetic of capture/pixel_rows.cpp and overlay/blend.cpp, integer for integer: what comes
// out is what the processor would have made of it, bit for bit.
inline constexpr char picture_frag[] = R"glsl(
precision highp usampler2D;
uniform usampler2D u_first, u_second, u_third;  // planes of the picture as captured
uniform usampler2D u_layer;                     // premultiplied
uniform ivec2 u_origin;                         // of the picture on the screen
uniform ivec4 u_layer_rect;                     // x0 y0 x1 y1 in the picture; empty: no layer
uniform int u_kind;                             // how the picture is stored
uniform ivec2 u_chroma_shift;                   // planes of chroma are halved this often
uniform int u_y_offset, u_y, u_v_red, u_u_blue; // 16 fractional bits but for the first
uniform ivec2 u_green;                          // of U and V
uniform bool u_expand;                          // RGB of limited range
out vec4 color;

// As PicturePainter::Kind.
const int GRAY = 0, RGB24 = 1, BGR24 = 2, RGB32 = 3, BGR32 = 4, YUYV = 5, UYVY = 6, PLANAR = 8;
const int half_step = 32768;

int byteAt(int x, int y) { return int(texelFetch(u_first, ivec2(x, y), 0).r); }

ivec3 level(ivec3 fixed_point) { return clamp(fixed_point >> 16, 0, 255); }

ivec3 fromYuv(int y, int u, int v) {
  int luma = u_y * (y - u_y_offset) + half_step;
  return level(ivec3(luma + u_v_red * (v - 128),
                     luma + u_green.x * (u - 128) + u_green.y * (v - 128),
                     luma + u_u_blue * (u - 128)));
}

ivec3 pictureAt(ivec2 at) {
  if (u_kind == GRAY) return level(ivec3(u_y * (byteAt(at.x, at.y) - u_y_offset) + half_step));
  if (u_kind == RGB24 || u_kind == BGR24) {
    int x = 3 * at.x;
    ivec3 triple = ivec3(byteAt(x, at.y), byteAt(x + 1, at.y), byteAt(x + 2, at.y));
    return u_kind == RGB24 ? triple : triple.bgr;
  }
  if (u_kind == RGB32) return ivec3(texelFetch(u_first, at, 0).rgb);
  if (u_kind == BGR32) return ivec3(texelFetch(u_first, at, 0).bgr);
  if (u_kind == YUYV || u_kind == UYVY) {
    ivec4 pair = ivec4(texelFetch(u_first, ivec2(at.x >> 1, at.y), 0));
    if (u_kind == UYVY) pair = pair.grab;
    return fromYuv((at.x & 1) == 0 ? pair.r : pair.b, pair.g, pair.a);
  }
  ivec2 chroma = at >> u_chroma_shift;
  ivec2 uv = ivec2(texelFetch(u_second, chroma, 0).rg);
  if (u_kind == PLANAR) uv.y = int(texelFetch(u_third, chroma, 0).r);
  return fromYuv(byteAt(at.x, at.y), uv.x, uv.y);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) - u_origin;
  ivec3 rgb = pictureAt(at);
  if (u_expand) rgb = level(u_y * (rgb - 16) + half_step);
  if (all(greaterThanEqual(at, u_layer_rect.xy)) && all(lessThan(at, u_layer_rect.zw))) {
    ivec4 layer = ivec4(texelFetch(u_layer, at, 0));
    ivec3 t = rgb * (255 - layer.a) + 128;
    if (layer.a != 0) rgb = min(layer.rgb + ((t + (t >> 8)) >> 8), 255);
  }
  color = vec4(vec3(rgb) / 255.0, 1.0);
}
)glsl";

}  // namespace depthscope::platform::shader_text
