#include "btf/view_file.h"

#include <ImfAttribute.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "btf/atomic_file.h"
#include "btf/error.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

constexpr const char* channel_names[] = {"R", "G", "B"};

constexpr const char* error_suffix = ".error";
constexpr const char* coverage_part = "alpha";

std::string part_name(std::size_t light) {
  return fmt::format("light_{:03}", light);
}

Imf::Header part_header(const ViewFileHeader& file, const std::string& name) {
  Imf::Header header(file.width, file.height);
  // Sixteen lines are packed together. Line by line (ZIPS) takes three times as long, and a quarter
  // more space. Noise hardly packs: the quickest level takes half the time for 3 % more space.
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = 1;
  header.setName(name);
  header.setType(Imf::SCANLINEIMAGE);
  header.insert("weftProvenance", Imf::StringAttribute(file.provenance));
  return header;
}

std::vector<Imf::Header> part_headers(const ViewFileHeader& file, const Direction& view,
                                      std::span<const Direction> lights, const ViewData& data) {
  const Imf::PixelType type = file.pixel_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
  std::vector<Imf::Header> headers;
  const auto add_lights = [&](const std::string& suffix) {
    for (std::size_t l = 0; l < lights.size(); ++l) {
      Imf::Header header = part_header(file, part_name(l) + suffix);
      for (const char* name : channel_names) header.channels().insert(name, Imf::Channel(type));
      header.insert("viewTheta", Imf::FloatAttribute(degrees(theta_of(view))));
      header.insert("viewPhi", Imf::FloatAttribute(degrees(phi_of(view))));
      header.insert("lightTheta", Imf::FloatAttribute(degrees(theta_of(lights[l]))));
      header.insert("lightPhi", Imf::FloatAttribute(degrees(phi_of(lights[l]))));
      if (suffix.empty() && !data.standard_errors.empty()) {
        header.insert("standardError", Imf::FloatAttribute(data.standard_errors[l]));
      }
      headers.push_back(header);
    }
  };
  add_lights("");
  if (!data.texel_errors.empty()) add_lights(error_suffix);
  if (!data.coverage.empty()) {
    Imf::Header header = part_header(file, coverage_part);
    header.channels().insert("A", Imf::Channel(Imf::FLOAT));
    header.insert("viewTheta", Imf::FloatAttribute(degrees(theta_of(view))));
    header.insert("viewPhi", Imf::FloatAttribute(degrees(phi_of(view))));
    headers.push_back(header);
  }
  return headers;
}

// Slices of interleaved RGB values of one type.
template <typename Value>
Imf::FrameBuffer frame_buffer(const Value* rgb, int width) {
  const Imf::PixelType type = sizeof(Value) == 2 ? Imf::HALF : Imf::FLOAT;
  Imf::FrameBuffer buffer;
  for (int c = 0; c < 3; ++c) {
    char* base = const_cast<char*>(reinterpret_cast<const char*>(rgb + c));
    buffer.insert(channel_names[c],
                  Imf::Slice(type, base, 3 * sizeof(Value), 3 * sizeof(Value) * width));
  }
  return buffer;
}

Imf::FrameBuffer coverage_buffer(const float* coverage, int width) {
  Imf::FrameBuffer buffer;
  buffer.insert("A",
                Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(coverage)),
                           sizeof(float), sizeof(float) * width));
  return buffer;
}

std::string attribute(const Imf::Header& header, const char* name) {
  const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
  return text != nullptr ? text->value() : std::string();
}

Error unreadable(const fs::path& path, const std::string& why) {
  return bad_input(path.string(), "cannot be read: " + why,
                   "it may be truncated or not a view of a BTF; trace or copy it again");
}

Imf::MultiPartInputFile open_view(const fs::path& path) {
  if (!fs::exists(path)) throw bad_input(path.string(), "is missing");
  try {
    return Imf::MultiPartInputFile(path.c_str(), 0);
  } catch (const std::exception& error) {
    throw unreadable(path, error.what());
  }
}

// OpenEXR's message with the file's own name in place of the temporary one.
std::string renamed(std::string message, const fs::path& temporary, const fs::path& path) {
  const auto at = message.find(temporary.string());
  if (at != std::string::npos) message.replace(at, temporary.string().size(), path.string());
  return message;
}

void write_parts(const fs::path& path, const ViewFileHeader& header,
                 const std::vector<Imf::Header>& parts, const ViewData& data) {
  const std::size_t part_size = static_cast<std::size_t>(3) * header.width * header.height;
  Imf::MultiPartOutputFile file(path.c_str(), parts.data(), static_cast<int>(parts.size()), false,
                                0);
  std::vector<half> halfs(header.pixel_type == PixelType::half ? part_size : 0);
  int next = 0;
  const auto write_lights = [&](std::span<const float> values) {
    for (; !values.empty(); values = values.subspan(part_size)) {
      Imf::OutputPart out(file, next++);
      if (header.pixel_type == PixelType::half) {
        for (std::size_t i = 0; i < part_size; ++i) halfs[i] = values[i];
        out.setFrameBuffer(frame_buffer(halfs.data(), header.width));
      } else {
        out.setFrameBuffer(frame_buffer(values.data(), header.width));
      }
      out.writePixels(header.height);
    }
  };
  write_lights(data.values);
  write_lights(data.texel_errors);
  if (data.coverage.empty()) return;
  Imf::OutputPart out(file, next);
  out.setFrameBuffer(coverage_buffer(data.coverage.data(), header.width));
  out.writePixels(header.height);
}

// OpenEXR swallows errors when it closes a file: what is on disk tells.
bool is_whole(const fs::path& path) {
  try {
    const Imf::MultiPartInputFile written(path.c_str(), 0);
    for (int l = 0; l < written.parts(); ++l) {
      if (!written.partComplete(l)) return false;
    }
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

void write_view_file(const fs::path& path, const ViewFileHeader& header, const Direction& view,
                     std::span<const Direction> lights, const ViewData& data) {
  const std::vector<Imf::Header> parts = part_headers(header, view, lights, data);
  write_atomically(path, [&](const fs::path& temporary) {
    errno = 0;
    try {
      write_parts(temporary, header, parts, data);
    } catch (const std::exception& error) {
      throw failed(path.string(), "cannot be written: " + renamed(error.what(), temporary, path));
    }
    if (!is_whole(temporary)) {
      throw failed(path.string(), "cannot be written whole", "is the disk full?");
    }
  });
}

ViewFileHeader read_view_header(const fs::path& path) {
  const Imf::MultiPartInputFile file = open_view(path);
  const Imf::Header& part = file.header(0);
  const Imath::Box2i window = part.dataWindow();
  ViewFileHeader header;
  header.width = window.max.x - window.min.x + 1;
  header.height = window.max.y - window.min.y + 1;
  const Imf::Channel* red = part.channels().findChannel("R");
  header.pixel_type =
      red != nullptr && red->type == Imf::FLOAT ? PixelType::float32 : PixelType::half;
  header.provenance = attribute(part, "weftProvenance");
  return header;
}

ViewNotes read_view_notes(const fs::path& path) {
  const Imf::MultiPartInputFile file = open_view(path);
  ViewNotes notes{.provenance = attribute(file.header(0), "weftProvenance"), .standard_errors = {}};
  for (int l = 0; l < file.parts(); ++l) {
    const auto* value = file.header(l).findTypedAttribute<Imf::FloatAttribute>("standardError");
    if (value == nullptr) break;
    notes.standard_errors.push_back(value->value());
  }
  return notes;
}

namespace {

// Number of the first part whose name ends so; -1 where there is none.
int first_part(const Imf::MultiPartInputFile& file, const std::string& ending) {
  for (int p = 0; p < file.parts(); ++p) {
    if (file.header(p).hasName() && file.header(p).name().ends_with(ending)) return p;
  }
  return -1;
}

void check_part(const fs::path& path, const Imf::Header& header, int part, int width, int height) {
  const Imath::Box2i window = header.dataWindow();
  if (window.max.x - window.min.x + 1 != width || window.max.y - window.min.y + 1 != height) {
    throw bad_input(path.string(), fmt::format("part {} is {} x {}; expected {} x {} texels", part,
                                               window.max.x - window.min.x + 1,
                                               window.max.y - window.min.y + 1, width, height));
  }
  if (window.min != Imath::V2i(0, 0)) {
    throw bad_input(path.string(), fmt::format("part {} starts at ({}, {}); expected (0, 0)", part,
                                               window.min.x, window.min.y));
  }
}

void read_part(const fs::path& path, Imf::MultiPartInputFile& file, int part,
               const Imf::FrameBuffer& buffer, int height) {
  for (auto slice = buffer.begin(); slice != buffer.end(); ++slice) {
    if (file.header(part).channels().findChannel(slice.name()) == nullptr) {
      throw bad_input(path.string(), fmt::format("part {} has no channel {}", part, slice.name()));
    }
  }
  try {
    Imf::InputPart in(file, part);
    in.setFrameBuffer(buffer);
    in.readPixels(0, height - 1);
  } catch (const std::exception& error) {
    throw unreadable(path, error.what());
  }
}

// [light][y][x][rgb] of as many parts from `first` on.
std::vector<float> read_lights(const fs::path& path, Imf::MultiPartInputFile& file, int first,
                               int width, int height, std::size_t lights) {
  const std::size_t part_size = static_cast<std::size_t>(3) * width * height;
  std::vector<float> values(part_size * lights);
  for (std::size_t l = 0; l < lights; ++l) {
    const int part = first + static_cast<int>(l);
    check_part(path, file.header(part), part, width, height);
    read_part(path, file, part, frame_buffer(values.data() + l * part_size, width), height);
  }
  return values;
}

}  // namespace

std::vector<float> read_view_values(const fs::path& path, int width, int height,
                                    std::size_t lights) {
  Imf::MultiPartInputFile file = open_view(path);
  const int errors = first_part(file, error_suffix);
  const int coverage = first_part(file, coverage_part);
  const int found = errors >= 0 ? errors : coverage >= 0 ? coverage : file.parts();
  if (found != static_cast<int>(lights)) {
    throw bad_input(path.string(),
                    fmt::format("has {} parts; expected {}, one a light", found, lights));
  }
  return read_lights(path, file, 0, width, height, lights);
}

std::vector<float> read_texel_errors(const fs::path& path, int width, int height,
                                     std::size_t lights) {
  Imf::MultiPartInputFile file = open_view(path);
  const int first = first_part(file, error_suffix);
  if (first < 0) return {};
  if (file.parts() < first + static_cast<int>(lights)) {
    throw bad_input(path.string(), fmt::format("has {} parts; expected {} with standard errors",
                                               file.parts() - first, lights));
  }
  return read_lights(path, file, first, width, height, lights);
}

std::vector<float> read_coverage(const fs::path& path, int width, int height) {
  Imf::MultiPartInputFile file = open_view(path);
  const int part = first_part(file, coverage_part);
  if (part < 0) return {};
  check_part(path, file.header(part), part, width, height);
  std::vector<float> coverage(static_cast<std::size_t>(width) * height);
  read_part(path, file, part, coverage_buffer(coverage.data(), width), height);
  return coverage;
}

}  // namespace weft
