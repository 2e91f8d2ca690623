#include "overlay/shader_program.hpp"

#include <string>

#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

GLuint compile(const char* name, GLenum stage, std::initializer_list<std::string_view> parts) {
  std::string source =
      "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";
  for (std::string_view part : parts) source += part;
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    char log[512] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    const std::string reason(log);
    throw InputError(std::string("overlay: the driver refuses the ") + name +
                     (stage == GL_VERTEX_SHADER ? " vertex" : " fragment") +
                     " shader: " + reason.substr(0, reason.find('\n')));
  }
  return shader;
}

}  // namespace

ShaderProgram::ShaderProgram(const char* name, std::initializer_list<std::string_view> vertex,
                             std::initializer_list<std::string_view> fragment) {
  const GLuint v = compile(name, GL_VERTEX_SHADER, vertex);
  const GLuint f = compile(name, GL_FRAGMENT_SHADER, fragment);
  program_ = glCreateProgram();
  glAttachShader(program_, v);
  glAttachShader(program_, f);
  glLinkProgram(program_);
  glDeleteShader(v);
  glDeleteShader(f);
  GLint ok = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &ok);
  if (!ok) {
    glDeleteProgram(program_);
    throw InputError(std::string("overlay: the driver does not link the ") + name + " shaders");
  }
}

}  // namespace depthscope::overlay
