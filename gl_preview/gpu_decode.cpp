// A compute shader that decodes one query an invocation.

#include "gl_preview/gpu_decode.h"

#include <array>

#include "gl_preview/gl_context.h"
#include "gl_preview/gl_shader.h"
#include "gl_preview/gpu_appearance.h"

namespace weft {

namespace {

constexpr std::size_t group_size = 64;
/// 65,535 groups of 64 are sure to be allowed; this keeps the buffers at 64 MB.
constexpr std::size_t batch = std::size_t{1} << 20;

constexpr const char* main_source = R"(
struct WeftQuery { vec4 uv_lod; vec4 light; vec4 view; };
layout(std430, binding = 0) readonly buffer WeftQueries { WeftQuery weft_queries[]; };
layout(std430, binding = 1) writeonly buffer WeftAnswers { vec4 weft_answers[]; };
layout(local_size_x = 64) in;
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(weft_queries.length())) return;
  WeftQuery q = weft_queries[i];
  weft_answers[i] = vec4(btf_evaluate(q.uv_lod.xy, q.light.xyz, q.view.xyz, q.uv_lod.z), 1.0);
}
)";

using Vec4 = std::array<float, 4>;
struct PackedQuery {
  Vec4 uv_lod;
  Vec4 light;
  Vec4 view;
};

GlBuffer storage_buffer(GLuint binding, std::size_t bytes, const void* data, GLbitfield flags) {
  auto buffer = GlBuffer::make();
  glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), data, flags);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.name());
  return buffer;
}

void decode_batch(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) {
  std::vector<PackedQuery> packed;
  packed.reserve(queries.size());
  for (const AppearanceQuery& q : queries) {
    packed.push_back({{q.uv.x, q.uv.y, q.lod, 0},
                      {q.light.x, q.light.y, q.light.z, 0},
                      {q.view.x, q.view.y, q.view.z, 0}});
  }
  const GlBuffer input = storage_buffer(0, packed.size() * sizeof(PackedQuery), packed.data(), 0);
  const GlBuffer output =
      storage_buffer(1, packed.size() * sizeof(Vec4), nullptr, GL_CLIENT_STORAGE_BIT);
  check_gl("decoding on the GPU");
  glDispatchCompute(static_cast<GLuint>((packed.size() + group_size - 1) / group_size), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<Vec4> values(packed.size());
  glGetNamedBufferSubData(output.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(Vec4)),
                          values.data());
  check_gl("decoding on the GPU");
  for (std::size_t i = 0; i < values.size(); ++i) {
    answers[i] = Rgb(values[i][0], values[i][1], values[i][2]);
  }
}

}  // namespace

std::vector<Rgb> decode_on_gpu(const GlProgram& program, std::span<const AppearanceQuery> queries) {
  const GpuAppearance appearance(program, "decoding on the GPU");
  const GlLinkedProgram compute = link_compute_program(
      "decoding on the GPU", "#version 450 core\n" + appearance.source() + main_source);
  glUseProgram(compute.name());
  appearance.bind();
  std::vector<Rgb> answers(queries.size());
  for (std::size_t begin = 0; begin < queries.size(); begin += batch) {
    const std::size_t count = std::min(batch, queries.size() - begin);
    decode_batch(queries.subspan(begin, count), std::span(answers).subspan(begin, count));
  }
  return answers;
}

}  // namespace weft
