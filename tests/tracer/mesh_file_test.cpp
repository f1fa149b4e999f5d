// OBJ and PLY: names, polygons, frames, and what is refused with its place.
#include "tracer/mesh_file.h"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "btf/error.h"
#include "tests/temporary_folder.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

std::filesystem::path write(const TemporaryFolder& folder, const std::string& name,
                            const std::string& content) {
  std::ofstream(folder.path / name, std::ios::binary) << content;
  return folder.path / name;
}

TriangleMesh read(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  return read_mesh(write(folder, name, content));
}

std::string refusal(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  const std::filesystem::path file = write(folder, name, content);
  try {
    read_mesh(file);
  } catch (const Error& error) {
    CHECK(error.kind() == Error::Kind::bad_input);
    CHECK_THAT(error.what(), Contains(name));
    return error.what();
  }
  return "no error";
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string ply_header(const std::string& format, int vertices, int faces) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

template <typename T>
void append(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian == (std::endian::native == std::endian::little))
    std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string binary_ply(bool big_endian) {
  std::string bytes = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", 4, 1);
  for (const float value : {0., 0., 0., 1., 0., 0., 1., 1., .5, 0., 1., .25}) {
    append(bytes, static_cast<float>(value), big_endian);
  }
  append(bytes, static_cast<std::uint8_t>(4), big_endian);
  for (const int i : {0, 1, 2, 3}) append(bytes, i, big_endian);
  return bytes;
}

}  // namespace

TEST_CASE("an OBJ keeps its usemtl names, then its group and object names") {
  const TriangleMesh mesh =
      read("names.obj", square +
                            "mtllib not_there.mtl\nf 1 2 3\nusemtl red brick\nf 1 2 3 4\n"
                            "usemtl mortar\nf 1 3 4\nusemtl red brick\nf 2 3 4\n");
  CHECK(mesh.material_names == std::vector<std::string>{"default", "red brick", "mortar"});
  CHECK(mesh.materials == std::vector<std::uint16_t>{0, 1, 1, 2, 1});
  CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(mesh.triangles[2] == std::array<std::uint32_t, 3>{0, 2, 3});

  const TriangleMesh groups =
      read("groups.obj", square + "o cup\nf 1 2 3\ng handle rest\nf 1 3 4\n");
  CHECK(groups.material_names == std::vector<std::string>{"cup", "handle"});
}

TEST_CASE("OBJ indices may count from the end, and corners that differ are apart") {
  const TriangleMesh mesh = read(
      "uv.obj",
      square + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 2\r\nf 1/1/1 2/2/1 3/3/1\nf -4/3/1 -2/3/1 -1/1/1\n");
  REQUIRE(mesh.triangles.size() == 2);
  CHECK(mesh.positions.size() == 5);  // position 1 has two texcoords
  CHECK(mesh.normals.front() == Vec3(0, 0, 1));
  CHECK(mesh.texcoords[mesh.triangles[1][0]] == Vec2(1, 1));
  CHECK(mesh.positions[mesh.triangles[1][2]] == Vec3(0, 1, 0));
  // One face without texcoords: none are kept.
  CHECK(read("part.obj", square + "vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n").texcoords.empty());
}

TEST_CASE("PLY: ASCII and binary of both byte orders hold the same mesh") {
  const TriangleMesh ascii =
      read("a.ply", ply_header("ascii", 4, 1) + "0 0 0\n1 0 0\n1 1 0.5\n0 1 0.25\n4 0 1 2 3\n");
  const TriangleMesh little = read("l.ply", binary_ply(false));
  const TriangleMesh big = read("b.ply", binary_ply(true));
  REQUIRE(ascii.triangles.size() == 2);
  CHECK(ascii.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0.25}});
  CHECK(ascii.material_names == std::vector<std::string>{"default"});
  for (const TriangleMesh* mesh : {&little, &big}) {
    CHECK(mesh->positions == ascii.positions);
    CHECK(mesh->triangles == ascii.triangles);
  }
}

TEST_CASE("PLY: normals and texcoords of the vertices are kept, and normals made unit") {
  const TriangleMesh mesh =
      read("dressed.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\n"
           "property float x\nproperty float y\nproperty float z\n"
           "property float nx\nproperty float ny\nproperty float nz\n"
           "property float s\nproperty float t\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 0 0 2 0 0\n1 0 0 0.6 0 0.8 1 0\n1 1 0 0 0.6 0.8 1 0.5\n0 1 0 0 0 1 0 0.5\n"
           "4 0 1 2 3\n");
  CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(mesh.texcoords == std::vector<Vec2>{{0, 0}, {1, 0}, {1, 0.5F}, {0, 0.5F}});
  const std::vector<Vec3> normals = {{0, 0, 1}, {0.6F, 0, 0.8F}, {0, 0.6F, 0.8F}, {0, 0, 1}};
  REQUIRE(mesh.normals.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK((mesh.normals[i] - normals[i]).length() < 1e-6F);
}

TEST_CASE("bad meshes are refused with file and line") {
  CHECK_THAT(refusal("empty.obj", ""), Contains("mesh has no faces"));
  CHECK_THAT(refusal("points.obj", square), Contains("mesh has no faces"));
  CHECK_THAT(refusal("points.ply", ply_header("ascii", 1, 0) + "0 0 0\n"), Contains("no faces"));
  CHECK_THAT(refusal("nan.obj", "v 0 0 0\nv 1 nan 0\nv 1 1 0\nf 1 2 3\n"),
             Contains("nan.obj:2: 'nan' is not a finite number"));
  CHECK_THAT(refusal("huge.obj", "v 0 0 1e99\n"), Contains("huge.obj:1: '1e99'"));
  CHECK_THAT(refusal("word.obj", "v 0 0\n"), Contains("word.obj:1: 'v' has 2 numbers"));
  CHECK_THAT(refusal("range.obj", square + "f 1 2 3\nf 1 2 5\n"),
             Contains("range.obj:6: position 5 is out of range: 4 were given"));
  CHECK_THAT(refusal("back.obj", square + "f 1 2 -5\n"), Contains("back.obj:5: position -5"));
  CHECK_THAT(refusal("zero.obj", square + "f 0 1 2\n"), Contains("zero.obj:5"));
  CHECK_THAT(refusal("line.obj", square + "f 1 2\n"), Contains("line.obj:5: a face has 2 corners"));
  CHECK_THAT(refusal("nan.ply", ply_header("ascii", 3, 1) + "0 0 nan\n1 0 0\n1 1 0\n3 0 1 2\n"),
             Contains("vertex 0"));
  CHECK_THAT(refusal("range.ply", ply_header("ascii", 3, 1) + "0 0 0\n1 0 0\n1 1 0\n3 0 1 7\n"),
             Contains("vertex 7"));
  CHECK_THAT(refusal("half.ply", ply_header("ascii", 3, 1) + "0 0 0\n1 0"),
             Contains("the line of vertex 1 of 3 ends early"));
  CHECK_THAT(refusal("gone.ply", ply_header("ascii", 3, 1) + "0 0 0\n1 0 0\n"),
             Contains("the file ends within vertex 2 of 3"));
  CHECK_THAT(refusal("row.ply", ply_header("ascii", 3, 1) + "0 0 0\n1 0 0\n1 1 0\n4 0 1 2\n"),
             Contains("the line of face 0 of 1 ends early"));
  for (const bool big_endian : {false, true}) {
    const std::string whole = binary_ply(big_endian);
    const std::size_t header = whole.find("end_header\n") + 11;
    for (std::size_t length = header; length < whole.size(); ++length) {
      const bool in_vertices = length < header + 4 * 12;
      CHECK_THAT(refusal("cut.ply", whole.substr(0, length)),
                 Contains(in_vertices ? "ends within vertex" : "ends within face 0 of 1"));
    }
  }
  CHECK_THAT(refusal("header.ply", ply_header("ascii", 3, 1).substr(0, 60)),
             Contains("within its header"));
  CHECK_THAT(refusal("garbage.ply", "this is no mesh"),
             Contains("garbage.ply:1") && Contains("begins with"));
  CHECK_THAT(refusal("mesh.stl", "solid"), Contains("known: .obj, .ply"));
  CHECK_THROWS_WITH(read_mesh("/nowhere/a.obj"),
                    Contains("/nowhere/a.obj") && Contains("No such file"));
}

TEST_CASE("frames follow the texcoords, mirrored ones too") {
  TriangleMesh mesh =
      read("frame.obj", square + "vt 0 0\nvt 0 1\nvt -1 1\nvt -1 0\nf 1/1 2/2 3/3 4/4\n");
  complete_frames(mesh);
  for (const Vec3& normal : mesh.normals) CHECK((normal - Vec3(0, 0, 1)).length() < 1e-6F);
  for (const Vec3& tangent : mesh.tangents) CHECK((tangent - Vec3(0, -1, 0)).length() < 1e-6F);

  TriangleMesh mirrored =
      read("mirror.obj", square + "vt 0 0\nvt -1 0\nvt -1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
  complete_frames(mirrored);
  for (const Vec3& tangent : mirrored.tangents) CHECK((tangent - Vec3(-1, 0, 0)).length() < 1e-6F);

  TriangleMesh bare = read("bare.obj", square + "f 4 3 2 1\n");
  complete_frames(bare);
  for (std::size_t i = 0; i < bare.positions.size(); ++i) {
    CHECK(bare.normals[i].z == Approx(-1));
    CHECK(bare.tangents[i].length() == Approx(1));
    CHECK(std::abs(bare.tangents[i].dot(bare.normals[i])) < 1e-6F);
  }
}
