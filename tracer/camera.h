// Rays of a perspective camera, with their differentials over one pixel.
#pragma once

#include "tracer/scene.h"

namespace weft {

struct CameraRay {
  Vec3 origin;
  Vec3 direction;  ///< unit
  /// Change of the unit direction from one pixel to the next, to the right and downwards.
  Vec3 direction_dx;
  Vec3 direction_dy;
};

class PerspectiveCamera {
 public:
  /// @throws Error  where eye and target coincide, `up` is along the view, fov is not in (0, 180)
  /// or the size is 0.
  explicit PerspectiveCamera(const Camera& camera);

  /// `x`, `y` in pixels from the picture's top left corner: pixel (0, 0) has its centre at (0.5,
  /// 0.5).
  CameraRay ray(double x, double y) const;

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_;
  int height_;
  Vec3 eye_;
  // Direction of the top left corner, and a pixel's step to the right and downwards, on the plane
  // at distance 1.
  Imath::V3d corner_;
  Imath::V3d step_x_;
  Imath::V3d step_y_;
};

}  // namespace weft
