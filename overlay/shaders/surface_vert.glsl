layout(location = 0) in vec3 a_position;  // surface frame
layout(location = 1) in vec4 a_bary_fade; // place in the original triangle; visibility 0..1
uniform mat3 u_R_camera_surface;
uniform vec3 u_t_camera_surface;
#ifdef CUE_MESH
out vec3 v_bary;
#endif
out float v_fade;   // far below 0 all over a triangle with a corner that has no place in the picture

void main() {
  vec3 p = u_R_camera_surface * a_position + u_t_camera_surface;
#ifdef CUE_MESH
  v_bary = a_bary_fade.xyz;
#endif
  float valid;
  gl_Position = projectThroughLens(p, valid);
  v_fade = valid > 0.5 ? a_bary_fade.w : -1e6;
}
