#include "tracer/camera.h"

#include <cmath>

#include "btf/direction.h"
#include "btf/error.h"

namespace weft {

PerspectiveCamera::PerspectiveCamera(const Camera& camera)
    : width_(camera.width), height_(camera.height), eye_(camera.eye) {
  if (!(camera.fov > 0 && camera.fov < 180)) {
    throw bad_input("camera.fov", "the field of view is not between 0 and 180 degrees");
  }
  if (width_ < 1 || height_ < 1) throw bad_input("camera.size", "the picture has no pixels");
  const Imath::V3d forward = Imath::V3d(camera.target) - Imath::V3d(camera.eye);
  if (forward.length() == 0) throw bad_input("camera", "eye and target are the same point");
  const Imath::V3d ahead = forward.normalized();
  const Imath::V3d sideways = ahead.cross(Imath::V3d(camera.up));
  if (!(sideways.length() > 1e-6 * Imath::V3d(camera.up).length())) {
    throw bad_input("camera.up", "it is along the line from eye to target");
  }
  const Imath::V3d right = sideways.normalized();
  const Imath::V3d above = right.cross(ahead);
  const double half_height = std::tan(radians(static_cast<double>(camera.fov)) / 2);
  const double pixel = 2 * half_height / height_;
  step_x_ = right * pixel;
  step_y_ = -above * pixel;
  corner_ = ahead - step_x_ * (width_ / 2.0) - step_y_ * (height_ / 2.0);
}

CameraRay PerspectiveCamera::ray(double x, double y) const {
  const Imath::V3d d = corner_ + step_x_ * x + step_y_ * y;
  const double inverse_length = 1 / d.length();
  const Imath::V3d unit = d * inverse_length;
  // The derivative of d / |d|.
  const auto differential = [&](const Imath::V3d& step) {
    return Vec3((step - unit * unit.dot(step)) * inverse_length);
  };
  return {eye_, Vec3(unit), differential(step_x_), differential(step_y_)};
}

}  // namespace weft
