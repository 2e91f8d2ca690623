#include "overlay/ink.hpp"

#include <cmath>

#include "overlay/shader_text.hpp"

namespace depthscope::overlay {

Ink::Ink()
    : program_("ink", {shader_text::ink_vert}, {shader_text::ink_frag}),
      picture_(program_.uniform("u_picture")),
      clip_depths_(program_.uniform("u_clip_depths")),
      alpha_(program_.uniform("u_alpha")) {
  shapes_.reserve(kCapacity);
  program_.use();
  glUniform1i(program_.uniform("u_text"), 0);
  glUniform1i(program_.uniform("u_depth"), 1);

  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  glBufferData(GL_ARRAY_BUFFER, kCapacity * sizeof(Shape), nullptr, GL_STREAM_DRAW);
  for (GLuint i = 0; i < 5; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, 4, GL_FLOAT, GL_FALSE, sizeof(Shape),
                          reinterpret_cast<const void*>(i * 4 * sizeof(float)));
    glVertexAttribDivisor(i, 1);
  }
  glBindVertexArray(0);
  const GLuint farthest = 0xffffffffu;
  glBindTexture(GL_TEXTURE_2D, far_depth_.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, 1, 1, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
               &farthest);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void Ink::add(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size,
              const Eigen::Vector2f& axis, float radius, float stroke, Color color,
              const Anchor& anchor, const Eigen::Vector4f& extra) {
  if (shapes_.size() == kCapacity) return;
  shapes_.push_back(
      {{centre.x(), centre.y(), half_size.x(), half_size.y()},
       {axis.x(), axis.y(), radius, stroke},
       {color.r, color.g, color.b, color.a},
       {anchor.pixel.x(), anchor.pixel.y(), anchor.depth, static_cast<float>(anchor.when_hidden)},
       {extra[0], extra[1], extra[2], extra[3]}});
}

void Ink::box(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size, float radius,
              float stroke, Color color, const Anchor& anchor) {
  add(centre, half_size, {1, 0}, radius, stroke, color, anchor, Eigen::Vector4f::Zero());
}

void Ink::line(const Eigen::Vector2f& from, const Eigen::Vector2f& to, float width, Color color,
               const Anchor& anchor, float dash_px) {
  const float length = (to - from).norm();
  const Eigen::Vector2f axis =
      length > 1e-3f ? Eigen::Vector2f((to - from) / length) : Eigen::Vector2f(1, 0);
  add(0.5f * (from + to), {0.5f * (length + width), 0.5f * width}, axis, 0.5f * width, 0, color,
      anchor, {0, 0, 0, dash_px});
}

void Ink::text(const Eigen::Vector2f& top_left, const TextSpot& spot, Color color,
               const Anchor& anchor) {
  if (spot.empty()) return;
  const Eigen::Vector2f half(0.5f * static_cast<float>(spot.width),
                             0.5f * static_cast<float>(spot.height));
  const Eigen::Vector2f corner(std::round(top_left.x()), std::round(top_left.y()));
  // The box covers whole pixels, whose centres are at whole numbers.
  add(corner + half - Eigen::Vector2f(0.5f, 0.5f), half, {1, 0}, 0, 0, color, anchor,
      {static_cast<float>(spot.x), static_cast<float>(spot.y), 1, 0});
}

void Ink::draw(const Layer& layer, GLuint text_texture, GLuint depth_texture,
               std::array<float, 2> clip_depths, float alpha) {
  if (shapes_.empty()) return;
  program_.use();
  glUniform2f(picture_, static_cast<float>(layer.width()), static_cast<float>(layer.height()));
  glUniform2f(clip_depths_, clip_depths[0], clip_depths[1]);
  glUniform1f(alpha_, alpha);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth_texture != 0 ? depth_texture : far_depth_.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, text_texture);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(shapes_.size() * sizeof(Shape)),
                  shapes_.data());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(shapes_.size()));
  glDisable(GL_BLEND);
}

}  // namespace depthscope::overlay
