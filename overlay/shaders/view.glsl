// The view of the scope in the picture: 1 inside, 0 in its dark surroundings, soft over a few pixels on the
// inner side of the edge.
uniform highp sampler2D u_view;  // left and right end [px] of each band of rows
uniform vec2 u_view_scale;       // bands per row, 1 / width of the soft edge [px]

float inView() {
  float band = gl_FragCoord.y * u_view_scale.x - 0.5;  // window row 0 is the picture's top row
  int last = textureSize(u_view, 0).x - 1;
  int above = clamp(int(floor(band)), 0, last), below = min(above + 1, last);
  vec2 ends = mix(texelFetch(u_view, ivec2(above, 0), 0).rg, texelFetch(u_view, ivec2(below, 0), 0).rg,
                  clamp(band - float(above), 0.0, 1.0));
  return clamp(min(gl_FragCoord.x - ends.x, ends.y - gl_FragCoord.x) * u_view_scale.y, 0.0, 1.0);
}
