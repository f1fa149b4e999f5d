// Reads OBJ through tinyobjloader's callbacks, which keep `usemtl` names even where the .mtl file
// is absent.
#include "tracer/obj_file.h"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <map>
#include <streambuf>
#include <string_view>
#include <unordered_map>

#include "btf/error.h"

namespace weft {

namespace {

/// Hands a file to its reader line by line, so that a callback can ask for the line it came from;
/// and refuses coordinates that are no finite numbers, which tinyobjloader would take for zero.
class LineBuffer : public std::streambuf {
 public:
  LineBuffer(std::istream& source, std::string file) : source_(source), file_(std::move(file)) {}

  std::string where() const { return fmt::format("{}:{}", file_, line_number_); }

 protected:
  int_type underflow() override {
    if (!std::getline(source_, line_)) return traits_type::eof();
    ++line_number_;
    check_numbers();
    line_ += '\n';
    setg(line_.data(), line_.data(), line_.data() + line_.size());
    return traits_type::to_int_type(line_.front());
  }

 private:
  void check_numbers() const {
    std::string_view rest = line_;
    const auto next = [&rest] {
      const std::size_t begin = std::min(rest.find_first_not_of(" \t\r"), rest.size());
      rest.remove_prefix(begin);
      const std::string_view token = rest.substr(0, rest.find_first_of(" \t\r"));
      rest.remove_prefix(token.size());
      return token;
    };
    const std::string_view keyword = next();
    const std::size_t least = keyword == "v" || keyword == "vn" ? 3 : keyword == "vt" ? 1 : 0;
    if (least == 0) return;
    std::size_t count = 0;
    for (std::string_view token = next(); !token.empty() && token.front() != '#'; token = next()) {
      if (token.front() == '+') token.remove_prefix(1);
      double value = 0;
      const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
      const bool whole = error == std::errc() && end == token.data() + token.size();
      if (!whole || !std::isfinite(static_cast<float>(value))) {
        throw bad_input(where(), fmt::format("'{}' is not a finite number", token));
      }
      ++count;
    }
    if (count < least) {
      throw bad_input(where(),
                      fmt::format("'{}' has {} numbers, expected {}", keyword, count, least));
    }
  }

  std::istream& source_;
  std::string file_;
  std::string line_;
  std::size_t line_number_ = 0;
};

struct Corner {
  std::array<std::int64_t, 3> index;  ///< position, texcoord, normal; from 0, or -1 where absent
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::size_t h = 0;
    for (const std::int64_t i : c.index)
      h = (h ^ static_cast<std::size_t>(i)) * 0x9E3779B97F4A7C15ULL;
    return h ^ (h >> 29);
  }
};

/// Gathers what the callbacks bring.
class ObjReader {
 public:
  explicit ObjReader(const LineBuffer& lines) : lines_(lines) {}

  void add_position(const Vec3& p) { positions_.push_back(p); }
  void add_normal(const Vec3& n) { normals_.push_back(n); }
  void add_texcoord(const Vec2& t) { texcoords_.push_back(t); }
  void use_material(const std::string& name) { material_ = name; }
  void use_group(const std::string& name) { group_ = name; }

  void add_face(const tinyobj::index_t* indices, int count) {
    if (count < 3) {
      throw bad_input(lines_.where(),
                      fmt::format("a face has {} corners, expected at least 3", count));
    }
    for (int i = 0; i < count; ++i) {
      const Corner corner{{resolve(indices[i].vertex_index, positions_.size(), "position", true),
                           resolve(indices[i].texcoord_index, texcoords_.size(), "texcoord", false),
                           resolve(indices[i].normal_index, normals_.size(), "normal", false)}};
      all_have_texcoords_ &= corner.index[1] >= 0;
      all_have_normals_ &= corner.index[2] >= 0;
      corners_.push_back(corner);
    }
    mesh_.face_sizes.push_back(static_cast<std::uint32_t>(count));
    mesh_.materials.push_back(material_index(lines_.where()));
  }

  PolygonMesh finish() {
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices;
    for (Corner corner : corners_) {
      if (!all_have_texcoords_) corner.index[1] = -1;
      if (!all_have_normals_) corner.index[2] = -1;
      const auto fresh = static_cast<std::uint32_t>(mesh_.positions.size());
      const auto [vertex, added] = vertices.try_emplace(corner, fresh);
      mesh_.corners.push_back(vertex->second);
      if (!added) continue;
      mesh_.positions.push_back(positions_[corner.index[0]]);
      if (all_have_texcoords_) mesh_.texcoords.push_back(texcoords_[corner.index[1]]);
      if (all_have_normals_) mesh_.normals.push_back(normals_[corner.index[2]]);
    }
    return std::move(mesh_);
  }

 private:
  /// OBJ counts from 1, and from the end with negative numbers; 0 stands for a number that is not
  /// there.
  std::int64_t resolve(int raw, std::size_t count, const char* what, bool required) const {
    if (raw == 0 && !required) return -1;
    const std::int64_t index = raw > 0 ? raw - 1 : static_cast<std::int64_t>(count) + raw;
    if (raw == 0 || index < 0 || index >= static_cast<std::int64_t>(count)) {
      throw bad_input(
          lines_.where(),
          fmt::format("{} {} is out of range: {} were given before this line", what, raw, count));
    }
    return index;
  }

  std::uint16_t material_index(const std::string& where) {
    const std::string& name = !material_.empty() ? material_ : !group_.empty() ? group_ : default_;
    const auto fresh = mesh_.material_names.size();
    const auto [found, added] = names_.try_emplace(name, static_cast<std::uint16_t>(fresh));
    if (added) {
      if (fresh > 0xFFFF) throw bad_input(where, "has more than 65536 material names");
      mesh_.material_names.push_back(name);
    }
    return found->second;
  }

  const LineBuffer& lines_;
  PolygonMesh mesh_;
  std::vector<Vec3> positions_;
  std::vector<Vec3> normals_;
  std::vector<Vec2> texcoords_;
  std::vector<Corner> corners_;
  std::map<std::string, std::uint16_t> names_;
  std::string material_;
  std::string group_;
  const std::string default_ = "default";
  bool all_have_texcoords_ = true;
  bool all_have_normals_ = true;
};

std::string trimmed(std::string_view name) {
  const std::size_t begin = std::min(name.find_first_not_of(" \t\r"), name.size());
  const std::size_t end = name.find_last_not_of(" \t\r");
  return std::string(end == std::string_view::npos ? "" : name.substr(begin, end - begin + 1));
}

ObjReader& reader(void* user) {
  return *static_cast<ObjReader*>(user);
}

tinyobj::callback_t callbacks() {
  tinyobj::callback_t calls;
  calls.vertex_cb = [](void* user, float x, float y, float z, float) {
    reader(user).add_position({x, y, z});
  };
  calls.normal_cb = [](void* user, float x, float y, float z) {
    reader(user).add_normal(Vec3(x, y, z).normalized());
  };
  calls.texcoord_cb = [](void* user, float u, float v, float) {
    reader(user).add_texcoord({u, v});
  };
  calls.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
    reader(user).add_face(indices, count);
  };
  calls.usemtl_cb = [](void* user, const char* name, int) {
    reader(user).use_material(trimmed(name));
  };
  calls.group_cb = [](void* user, const char** names, int count) {
    reader(user).use_group(count > 0 ? trimmed(names[0]) : std::string());
  };
  calls.object_cb = [](void* user, const char* name) { reader(user).use_group(trimmed(name)); };
  return calls;
}

}  // namespace

PolygonMesh read_obj(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  LineBuffer lines(file, path.string());
  std::istream stream(&lines);
  stream.exceptions(std::ios::badbit);  // lets a refused line's own error through
  ObjReader obj(lines);
  tinyobj::LoadObjWithCallback(stream, callbacks(), &obj);
  return obj.finish();
}

}  // namespace weft
