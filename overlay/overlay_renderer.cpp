#include "overlay/overlay_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

using Eigen::Vector2f;

// From nothing to the whole overlay. Tracking that is lost for a picture or two dims it for a
// moment, where it would flash otherwise.
constexpr double kAppear_s = 0.2;
// From the whole overlay to nothing, when the pose is lost.
constexpr double kVanish_s = 0.1;

int labelTextPx(const OverlaySettings& s, int height) {
  return s.label_height_px > 0 ? static_cast<int>(std::lround(s.label_height_px))
                               : std::max(12, height / 34);
}

PixelRect whole(const Layer& layer) {
  return {0, 0, layer.width(), layer.height()};
}

Eigen::AlignedBox2f toBox(const PixelRect& r) {
  return {Vector2f(static_cast<float>(r.x0), static_cast<float>(r.y0)),
          Vector2f(static_cast<float>(r.x1), static_cast<float>(r.y1))};
}

}  // namespace

OverlayRenderer::OverlayRenderer(const CameraModel& camera, const OverlaySettings& settings)
    : camera_(camera),
      settings_(settings),
      max_labels_(std::max(settings.max_labels, 0)),
      rasterizer_(settings.font_file),
      view_(camera.width, camera.height),
      surface_pass_(camera, view_),
      inset_(camera, settings),
      labels_(camera, max_labels_) {
  warmUp();
}

/// Drivers translate shaders at the first draw call that needs them in just that state, which takes
/// longer than a picture lasts. So everything is drawn once, out of sight, before the first picture
/// comes.
void OverlayRenderer::warmUp() {
  const auto z = static_cast<float>(camera_.fx);
  SurfaceMesh mesh;
  mesh.vertices = {{-40, -40, z}, {40, -40, z}, {0, 40, z}};
  mesh.normals.assign(3, {0, 0, -1});
  mesh.confidence.assign(3, 1.0f);
  mesh.triangles = {{0, 2, 1}};
  const Label label{0, 0, {0, 0, z}, "warm"};
  OverlayState state;
  state.status = Status::Tracking;
  state.confidence = 1;
  const auto drawAt = [&](double time_s) {
    state.time_s = time_s;
    if (!draw(camera_.width, camera_.height, state, {}))
      throw InputError("overlay: the graphics driver fails to draw a " +
                       std::to_string(camera_.width) + " x " + std::to_string(camera_.height) +
                       " picture");
  };
  const OverlaySettings wanted = settings_;
  settings_.inset = settings_.labels = true;
  settings_.crossfade_s = 1;
  for (CueMode cue : {CueMode::Chromadepth, CueMode::Mesh}) {
    settings_.cue = cue;
    for (double t : {0.0, 0.5}) {
      setSurface(mesh);
      setLabels(std::span(&label, 1));
      drawAt(t);
      drawAt(t + 0.25);
    }
  }
  settings_ = wanted;
  for (int i = 0; i < 2; ++i) setSurface({});
  setLabels({});
  range_.reset();
  inset_.forget();
  last_time_s_ = -1;
  glFinish();
}

void OverlayRenderer::setSettings(const OverlaySettings& settings) {
  context_.makeCurrent();
  settings_ = settings;
  inset_.setSettings(settings);
  atlas_.reset();
}

void OverlayRenderer::setSurface(const SurfaceMesh& mesh) {
  if (context_.makeCurrent()) surfaces_.set(mesh, settings_);
}

void OverlayRenderer::setView(const ViewOutline& view) {
  if (context_.makeCurrent()) view_.set(view);
}

void OverlayRenderer::setLabels(std::span<const Label> labels) {
  labels_.set(labels);
  if (!context_.makeCurrent() || !atlas_) return;
  for (std::size_t i = 0; i < labels_.labels().size(); ++i)
    atlas_->set(static_cast<int>(i), labels_.labels()[i].text,
                labelTextPx(settings_, layer_.height()));
}

/// Makes layer and texts fit the picture's size. Allocates when that changes, and only then.
bool OverlayRenderer::prepare(int width, int height) {
  if (!context_.makeCurrent()) return false;
  const bool resized = width != layer_.width() || height != layer_.height();
  if (!layer_.resize(width, height)) return false;
  if (!resized && atlas_) return true;
  atlas_.emplace(rasterizer_, max_labels_, labelTextPx(settings_, height), width * 3 / 4);
  setLabels(labels_.labels());
  return true;
}

/// Time since the picture before [s]; negative when unknown.
double OverlayRenderer::advance(double time_s) {
  const double dt =
      time_s >= 0 && last_time_s_ >= 0 && time_s >= last_time_s_ ? time_s - last_time_s_ : -1;
  last_time_s_ = time_s;
  return dt;
}

/// The overlay comes gently, and goes gently as long as there is a pose to draw it by, within its
/// age limit; at once where the time is unknown.
float OverlayRenderer::ease(const OverlayState& state, double dt_s) const {
  const float wanted = poseAlpha(state, settings_);
  if (dt_s < 0) return wanted;
  const float most = alpha_ + static_cast<float>(dt_s / kAppear_s);
  float least = 0;
  if (state.fading && state.T_camera_world.allFinite())
    least = std::clamp(alpha_ - static_cast<float>(dt_s / kVanish_s), 0.0f,
                       ageAlpha(state.age_ms, settings_));
  return std::clamp(wanted, std::min(least, most), most);
}

std::optional<PixelRect> OverlayRenderer::draw(int width, int height, const OverlayState& state,
                                               const PixelRect& mark) {
  if (!prepare(width, height)) return std::nullopt;
  const double dt_s = advance(state.time_s);
  const bool camera_size = width == camera_.width && height == camera_.height;
  alpha_ = camera_size ? ease(state, dt_s) : 0;
  if (alpha_ <= 0 || settings_.cue == CueMode::Off) return PixelRect{};
  layer_.beginSolid();
  drawTissueCues(state, dt_s, alpha_, mark);
  if (glGetError() != GL_NO_ERROR) return std::nullopt;
  return whole(layer_);
}

/// Everything that hangs on a pose: cue, labels, turned-aside view.
void OverlayRenderer::drawTissueCues(const OverlayState& state, double dt_s, float alpha,
                                     const PixelRect& mark) {
  const SurfaceStack::Shown shown =
      surfaces_.shown(state.map_id, state.time_s, settings_.crossfade_s);
  const SurfaceStack::Surface* main = shown.main();
  if (range_map_ != state.map_id) {
    range_.reset();
    inset_.forget();
    range_map_ = state.map_id;
  }
  if (main)
    range_.update(main->prepared.samples, main->inCamera(state.T_camera_world), camera_, dt_s);
  const bool solid = main && range_.valid();
  const CueStyle style{settings_.cue, settings_.opacity, range_.nearDepth(), range_.farDepth()};

  ink_.clear();
  if (solid) drawCue(shown, style, state.T_camera_world, alpha);
  if (solid && settings_.inset) {
    inset_.frame(main->prepared, main->inCamera(state.T_camera_world), style.near_depth, dt_s);
    inset_.drawPanel(ink_);
    ink_.draw(layer_, atlas_->texture(), 0, {1, 2}, alpha);
    inset_.drawMesh(main->buffers, style, alpha);
    ink_.clear();
    inset_.drawMarks(settings_.labels ? labels_.labels() : std::span<const Label>(), main->prepared,
                     ink_);
  }
  if (settings_.labels) addLabels(state, mark, solid && settings_.inset);
  layer_.beginFlat();
  ink_.draw(layer_, atlas_->texture(), solid ? layer_.depthTexture() : 0,
            clipDepths(style.near_depth, style.far_depth), alpha);
}

void OverlayRenderer::drawCue(const SurfaceStack::Shown& shown, const CueStyle& style,
                              const Pose& T_camera_world, float alpha) {
  if (shown.before) {
    surface_pass_.draw(shown.before->buffers, shown.before->inCamera(T_camera_world), style,
                       alpha * (1 - shown.crossfade));
    if (shown.newest)
      surface_pass_.drawAdded(shown.newest->buffers, shown.newest->inCamera(T_camera_world), style,
                              alpha * shown.crossfade);
  } else if (shown.newest) {
    surface_pass_.draw(shown.newest->buffers, shown.newest->inCamera(T_camera_world), style,
                       alpha * shown.crossfade);
  }
}

void OverlayRenderer::addLabels(const OverlayState& state, const PixelRect& mark, bool inset) {
  const Eigen::AlignedBox2f obstacles[] = {toBox(mark), toBox(inset_.panel())};
  labels_.draw(state.T_camera_world, state.map_id, state.time_s, *atlas_,
               std::span(obstacles, inset ? 2 : 1), ink_);
}

bool OverlayRenderer::read(const PixelRect& rect, std::uint8_t* rgba) {
  layer_.read(rect, rgba);
  return glGetError() == GL_NO_ERROR;
}

}  // namespace depthscope::overlay
