// Camera frame -> clip space through the lens distortion, as CameraModel::project does it: Brown-Conrady
// (k1 k2 p1 p2 k3) or Kannala-Brandt (k1 k2 k3 k4).
uniform vec4 u_intrinsics;    // fx fy cx cy [px]
uniform float u_k[5];
uniform bool u_fisheye;
uniform float u_max_radius;   // of undistorted coordinates, beyond which the lens folds over
uniform vec2 u_picture;       // width, height [px]
uniform vec2 u_clip_depths;   // near, far plane

vec2 distort(vec2 n) {
  float r2 = dot(n, n);
  if (u_fisheye) {
    float r = sqrt(r2);
    if (r < 1e-6) return n;
    float a = atan(r);
    float a2 = a * a;
    return n * (a * (1.0 + a2 * (u_k[0] + a2 * (u_k[1] + a2 * (u_k[2] + a2 * u_k[3])))) / r);
  }
  float radial = 1.0 + r2 * (u_k[0] + r2 * (u_k[1] + r2 * u_k[4]));
  float xy2 = 2.0 * n.x * n.y;
  return n * radial + vec2(u_k[2] * xy2 + u_k[3] * (r2 + 2.0 * n.x * n.x),
                           u_k[2] * (r2 + 2.0 * n.y * n.y) + u_k[3] * xy2);
}

// `valid` is 1, or 0 where the point has no place in the picture (behind the camera, or past the fold). Such
// a point is put somewhere harmless; triangles it belongs to must not be drawn.
vec4 projectThroughLens(vec3 p, out float valid) {
  float z = max(p.z, u_clip_depths.x);
  vec2 n = p.xy / z;
  float r = length(n);
  valid = p.z >= u_clip_depths.x && r <= u_max_radius ? 1.0 : 0.0;
  if (r > u_max_radius) n *= u_max_radius / r;
  vec2 px = distort(n) * u_intrinsics.xy + u_intrinsics.zw;
  vec2 ndc = (px + 0.5) / u_picture * 2.0 - 1.0;
  float f = u_clip_depths.y, c = u_clip_depths.x;
  return vec4(ndc * z, (z * (f + c) - 2.0 * f * c) / (f - c), z);
}
