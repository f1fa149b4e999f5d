// A scene shape's mesh on the GPU.
#pragma once

#include "gl_preview/gl_object.h"
#include "tracer/scene.h"

namespace weft {

/// Attributes: 0 position, 1 normal, 2 tangent (each 3 floats), 3 texcoord (2 floats).
class GpuMesh {
 public:
  /// @throws Error  bad_input, naming the shape that lacks normals, tangents or texcoords.
  explicit GpuMesh(const SceneShape& shape);
  void draw() const;

 private:
  GlVertexArray array_;
  GlBuffer vertices_;
  GlBuffer indices_;
  GLsizei index_count_ = 0;
};

}  // namespace weft
