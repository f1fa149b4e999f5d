// Interleaving and uploading a mesh.

#include "gl_preview/gpu_mesh.h"

#include <cstddef>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

namespace weft {

namespace {

struct Vertex {
  Vec3 position;
  Vec3 normal;
  Vec3 tangent;
  Vec2 texcoord;
};

std::vector<Vertex> interleaved(const SceneShape& shape) {
  const TriangleMesh& mesh = shape.mesh;
  const std::size_t n = mesh.positions.size();
  if (mesh.normals.size() != n || mesh.tangents.size() != n || mesh.texcoords.size() != n) {
    throw bad_input("shape " + shape.name, "lacks a normal, tangent or texcoord at some vertex");
  }
  std::vector<Vertex> vertices(n);
  for (std::size_t i = 0; i < n; ++i) {
    vertices[i] = {mesh.positions[i], mesh.normals[i], mesh.tangents[i], mesh.texcoords[i]};
  }
  return vertices;
}

}  // namespace

GpuMesh::GpuMesh(const SceneShape& shape)
    : array_(GlVertexArray::make()),
      vertices_(GlBuffer::make()),
      indices_(GlBuffer::make()),
      index_count_(static_cast<GLsizei>(3 * shape.mesh.triangles.size())) {
  const std::vector<Vertex> vertices = interleaved(shape);
  if (vertices.empty() || index_count_ == 0) throw bad_input("shape " + shape.name, "has no faces");
  glNamedBufferStorage(vertices_.name(), static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                       vertices.data(), 0);
  glNamedBufferStorage(indices_.name(),
                       static_cast<GLsizeiptr>(index_count_ * sizeof(std::uint32_t)),
                       shape.mesh.triangles.data(), 0);
  glVertexArrayVertexBuffer(array_.name(), 0, vertices_.name(), 0, sizeof(Vertex));
  glVertexArrayElementBuffer(array_.name(), indices_.name());
  const auto attribute = [&](GLuint index, GLint components, std::size_t offset) {
    glEnableVertexArrayAttrib(array_.name(), index);
    glVertexArrayAttribFormat(array_.name(), index, components, GL_FLOAT, GL_FALSE,
                              static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(array_.name(), index, 0);
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 3, offsetof(Vertex, tangent));
  attribute(3, 2, offsetof(Vertex, texcoord));
  check_gl("shape " + shape.name);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace weft
