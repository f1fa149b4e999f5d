#include "btf/appearance.h"

namespace weft {

void Appearance::evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const {
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const AppearanceQuery& q = queries[i];
    answers[i] = evaluate(q.uv, q.light, q.view, q.lod);
  }
}

}  // namespace weft
