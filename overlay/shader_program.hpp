#pragma once
#include <GLES3/gl3.h>

#include <initializer_list>
#include <string_view>

namespace depthscope::overlay {

/// A linked pair of shaders. Sources are given in parts that are joined; the version line is added.
class ShaderProgram {
 public:
  /// Throws InputError with the compiler's first line when the driver refuses it. `name` is for
  /// that.
  ShaderProgram(const char* name, std::initializer_list<std::string_view> vertex,
                std::initializer_list<std::string_view> fragment);
  ~ShaderProgram() { glDeleteProgram(program_); }
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  void use() const { glUseProgram(program_); }
  GLint uniform(const char* name) const { return glGetUniformLocation(program_, name); }

 private:
  GLuint program_ = 0;
};

}  // namespace depthscope::overlay
