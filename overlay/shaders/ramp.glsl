// Pseudo-chromadepth: 0 near, 1 far. Cream, orange, rose, violet, deep blue; CIE lightness falls evenly from 94
// to 18, for luminance decides which of two surfaces looks nearer. Cubic fit to five hand-picked colours, sRGB.
vec3 depthColor(float t) {
  t = clamp(t, 0.0, 1.0);
  return vec3(0.965, 0.951, 0.623) +
         t * (vec3(0.579, -1.281, -2.529) + t * (vec3(-1.963, 0.089, 6.033) + t * vec3(0.493, 0.394, -3.732)));
}

// Place on the ramp of a depth. Even in 1 / depth, like disparity: a step near by, where instruments work, gets more of the
// colours than the same step far away. `scale`: near depth, near far / (far - near).
float inverseDepthPlace(float inverse_depth, vec2 scale) { return (1.0 / scale.x - inverse_depth) * scale.y; }
float depthPlace(float depth, vec2 scale) { return inverseDepthPlace(1.0 / max(depth, 1e-6), scale); }
