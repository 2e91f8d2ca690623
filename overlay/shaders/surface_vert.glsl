layout(location = 0) in vec3 a_position;  // surface frame
layout(location = 1) in vec4 a_bary_fade; // place in the original triangle; visibility 0..1
uniform mat3 u_R_camera_surface;
uniform vec3 u_t_camera_surface;
out vec3 v_bary;
out float v_fade;
out float v_valid;
out float v_depth;

void main() {
  vec3 p = u_R_camera_surface * a_position + u_t_camera_surface;
  v_bary = a_bary_fade.xyz;
  v_fade = a_bary_fade.w;
  v_depth = p.z;
  gl_Position = projectThroughLens(p, v_valid);
}
