layout(location = 0) in vec3 a_position;     // surface frame
layout(location = 1) in vec3 a_normal;       // unit, surface frame
layout(location = 2) in float a_fade;        // visibility 0..1
uniform mat3 u_R_camera_surface;             // of the scope: decides the colours
uniform vec3 u_t_camera_surface;
uniform mat3 u_R_view_surface;               // of the turned-aside view: decides where things are
uniform vec3 u_t_view_surface;
uniform vec3 u_view_scale;                   // x, y, depth -> -1..1, orthographic
out float v_depth;
out vec3 v_normal;
out float v_fade;

void main() {
  v_depth = (u_R_camera_surface * a_position + u_t_camera_surface).z;
  v_normal = u_R_view_surface * a_normal;
  v_fade = a_fade;
  gl_Position = vec4((u_R_view_surface * a_position + u_t_view_surface) * u_view_scale, 1.0);
}
