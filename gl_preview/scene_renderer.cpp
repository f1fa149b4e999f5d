// Meshes, programs and lights on the GPU, and the draw calls of one frame.

#include "gl_preview/scene_renderer.h"

#include <array>
#include <map>
#include <utility>

#include "btf/error.h"
#include "gl_preview/geometry_buffer.h"
#include "gl_preview/gl_context.h"
#include "gl_preview/gl_shader.h"
#include "gl_preview/gpu_appearance.h"
#include "gl_preview/gpu_mesh.h"
#include "gl_preview/scene_shaders.h"

namespace weft {

namespace {

/// As the shader's `WeftLight` (std430).
struct PackedLight {
  std::array<float, 4> position;  ///< w = 1; or the direction to a directional light, w = 0
  std::array<float, 4> power;     ///< intensity, or irradiance
};

std::vector<PackedLight> packed(const PreviewLights& lights) {
  std::vector<PackedLight> result;
  for (const PointLight& l : lights.points) {
    result.push_back({{l.position.x, l.position.y, l.position.z, 1},
                      {l.intensity.x, l.intensity.y, l.intensity.z, 0}});
  }
  for (const DirectionalLight& l : lights.directionals) {
    result.push_back({{l.direction.x, l.direction.y, l.direction.z, 0},
                      {l.irradiance.x, l.irradiance.y, l.irradiance.z, 0}});
  }
  return result;
}

/// A camera as uniforms: rows of the rotation into (right, up, forward), and the scales of x and y.
struct View {
  Vec3 right;
  Vec3 up;
  Vec3 forward;
  Vec2 scale;
};

View view_of(const Camera& camera) {
  View view;
  view.forward = (camera.target - camera.eye).normalized();
  view.right = view.forward.cross(camera.up).normalized();
  view.up = view.right.cross(view.forward);
  const double y = 1 / std::tan(radians(static_cast<double>(camera.fov)) / 2);
  view.scale = Vec2(static_cast<float>(y * camera.height / camera.width), static_cast<float>(y));
  return view;
}

}  // namespace

/// All that lives on the GPU.
struct SceneRenderer::Gpu {
  struct Material {
    std::size_t shader = 0;
    Vec2 repeat;
  };
  struct Shader {
    GpuAppearance appearance;
    GlLinkedProgram program;
    Vec2 texels;
    bool has_lod;
    GLint stencil;  ///< its mark on the pixels that see it
  };
  std::vector<Shader> shaders;
  std::vector<Material> materials;
  std::vector<GpuMesh> meshes;
  std::vector<std::size_t> material_of_mesh;
  GlLinkedProgram geometry_program =
      link_graphics_program("geometry pass", geometry_vertex_shader(), geometry_fragment_shader());
  GlVertexArray no_attributes = GlVertexArray::make();
  GeometryBuffer buffer;
  float extent = 1;  ///< largest coordinate, for the near plane

  void add_material(const SceneMaterial& material, std::map<const Appearance*, std::size_t>& known);
  void draw_geometry(const Camera& camera, FixedLod lod) const;
  void shade(const Camera& camera, int lights) const;
  void set_camera(const Camera& camera) const;
};

void SceneRenderer::Gpu::add_material(const SceneMaterial& material,
                                      std::map<const Appearance*, std::size_t>& known) {
  const Appearance& appearance = *material.appearance;
  const auto [found, is_new] = known.try_emplace(&appearance, shaders.size());
  if (is_new) {
    const std::string name = "material " + material.name;
    if (shaders.size() == GeometryBuffer::most_appearances) {
      throw failed(name, "the preview draws at most 255 different appearances in one scene");
    }
    GpuAppearance uploaded(gl_program_of(appearance, material.name), name);
    GlLinkedProgram program =
        link_graphics_program(name, full_screen_vertex_shader(),
                              shading_fragment_shader(uploaded.source(), uploaded.units()));
    const Imath::V2i texels = appearance.texels();
    shaders.push_back({std::move(uploaded), std::move(program),
                       Vec2(static_cast<float>(texels.x), static_cast<float>(texels.y)),
                       appearance.has_lod(), static_cast<GLint>(shaders.size()) + 1});
  }
  materials.push_back({found->second, material.repeat});
}

void SceneRenderer::Gpu::set_camera(const Camera& camera) const {
  const View view = view_of(camera);
  const std::array<Vec3, 3> rows = {view.right, view.up, view.forward};
  const GLuint program = geometry_program.name();
  glProgramUniform3fv(program, uniform::eye, 1, &camera.eye.x);
  glProgramUniform3fv(program, uniform::view_rows, 3, &rows[0].x);
  // Depth is near / distance: with an infinite far plane and floats, any small near plane will do.
  glProgramUniform3f(program, uniform::projection, view.scale.x, view.scale.y, 1e-5F * extent);
}

void SceneRenderer::Gpu::draw_geometry(const Camera& camera, FixedLod lod) const {
  buffer.begin_geometry();
  const GLuint program = geometry_program.name();
  glUseProgram(program);
  set_camera(camera);
  glProgramUniform1f(program, uniform::lod, lod.value_or(0));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Material& material = materials[material_of_mesh[i]];
    const Shader& shader = shaders[material.shader];
    glProgramUniform2f(program, uniform::repeat, material.repeat.x, material.repeat.y);
    glProgramUniform2f(program, uniform::texels, shader.texels.x, shader.texels.y);
    glProgramUniform1i(program, uniform::automatic_lod, !lod && shader.has_lod ? 1 : 0);
    glStencilFunc(GL_ALWAYS, shader.stencil, 0xFF);
    meshes[i].draw();
  }
}

void SceneRenderer::Gpu::shade(const Camera& camera, int lights) const {
  buffer.begin_shading();
  glBindVertexArray(no_attributes.name());
  for (const Shader& shader : shaders) {
    glUseProgram(shader.program.name());
    glProgramUniform3fv(shader.program.name(), uniform::eye, 1, &camera.eye.x);
    glProgramUniform1i(shader.program.name(), uniform::light_count, lights);
    shader.appearance.bind();
    buffer.bind_textures(static_cast<GLuint>(shader.appearance.units()));
    glStencilFunc(GL_EQUAL, shader.stencil, 0xFF);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
}

SceneRenderer::SceneRenderer(const Scene& scene) : gpu_(std::make_unique<Gpu>()) {
  std::map<const Appearance*, std::size_t> known;
  for (const SceneMaterial& material : scene.materials) gpu_->add_material(material, known);
  float extent = 0;
  for (const SceneShape& shape : scene.shapes) {
    gpu_->meshes.emplace_back(shape);
    gpu_->material_of_mesh.push_back(shape.material);
    for (const Vec3& p : shape.mesh.positions) {
      extent = std::max({extent, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  gpu_->extent = extent > 0 ? extent : 1;
}

SceneRenderer::~SceneRenderer() = default;
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;

void SceneRenderer::draw(const Camera& camera, const PreviewLights& lights, FixedLod lod) {
  if (gpu_->buffer.width() != camera.width || gpu_->buffer.height() != camera.height) {
    gpu_->buffer = GeometryBuffer(camera.width, camera.height);
  }
  std::vector<PackedLight> light_data = packed(lights);
  const auto light_count = static_cast<int>(light_data.size());
  if (light_data.empty()) light_data.resize(1);  // a buffer of no bytes cannot be bound
  const auto buffer = GlBuffer::make();
  glNamedBufferStorage(buffer.name(),
                       static_cast<GLsizeiptr>(light_data.size() * sizeof(PackedLight)),
                       light_data.data(), 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());

  // Reversed depth in [0, 1], and row 0 at the top.
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  gpu_->draw_geometry(camera, lod);
  gpu_->shade(camera, light_count);
  glDisable(GL_STENCIL_TEST);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  check_gl("drawing the preview");
}

Image SceneRenderer::read() const {
  Image image(gpu_->buffer.width(), gpu_->buffer.height());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindFramebuffer(GL_FRAMEBUFFER, gpu_->buffer.picture_framebuffer());
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_FLOAT, image.values.data());
  check_gl("reading the preview");
  return image;
}

unsigned SceneRenderer::picture() const {
  return gpu_->buffer.picture();
}

std::size_t SceneRenderer::bytes() const {
  std::size_t sum = 0;
  for (const auto& shader : gpu_->shaders) sum += shader.appearance.bytes();
  return sum;
}

}  // namespace weft
