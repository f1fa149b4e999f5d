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

std::vector<Imf::Header> part_headers(const ViewFileHeader& file, const Direction& view,
                                      std::span<const Direction> lights,
                                      std::span<const float> standard_errors) {
  const Imf::PixelType type = file.pixel_type == PixelType::half ? Imf::HALF : Imf::FLOAT;
  std::vector<Imf::Header> headers;
  for (std::size_t l = 0; l < lights.size(); ++l) {
    Imf::Header header(file.width, file.height);
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.setName(fmt::format("light_{:03}", l));
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* name : channel_names) header.channels().insert(name, Imf::Channel(type));
    header.insert("viewTheta", Imf::FloatAttribute(degrees(theta_of(view))));
    header.insert("viewPhi", Imf::FloatAttribute(degrees(phi_of(view))));
    header.insert("lightTheta", Imf::FloatAttribute(degrees(theta_of(lights[l]))));
    header.insert("lightPhi", Imf::FloatAttribute(degrees(phi_of(lights[l]))));
    header.insert("weftProvenance", Imf::StringAttribute(file.provenance));
    if (!standard_errors.empty()) {
      header.insert("standardError", Imf::FloatAttribute(standard_errors[l]));
    }
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
                 const std::vector<Imf::Header>& parts, std::span<const float> values) {
  const std::size_t part_size = static_cast<std::size_t>(3) * header.width * header.height;
  Imf::MultiPartOutputFile file(path.c_str(), parts.data(), static_cast<int>(parts.size()), false,
                                0);
  std::vector<half> halfs(header.pixel_type == PixelType::half ? part_size : 0);
  for (std::size_t l = 0; l < parts.size(); ++l) {
    const std::span<const float> part = values.subspan(l * part_size, part_size);
    Imf::OutputPart out(file, static_cast<int>(l));
    if (header.pixel_type == PixelType::half) {
      for (std::size_t i = 0; i < part_size; ++i) halfs[i] = part[i];
      out.setFrameBuffer(frame_buffer(halfs.data(), header.width));
    } else {
      out.setFrameBuffer(frame_buffer(part.data(), header.width));
    }
    out.writePixels(header.height);
  }
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
                     std::span<const Direction> lights, std::span<const float> values,
                     std::span<const float> standard_errors) {
  const std::vector<Imf::Header> parts = part_headers(header, view, lights, standard_errors);
  write_atomically(path, [&](const fs::path& temporary) {
    errno = 0;
    try {
      write_parts(temporary, header, parts, values);
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

std::vector<float> read_standard_errors(const fs::path& path) {
  const Imf::MultiPartInputFile file = open_view(path);
  std::vector<float> errors;
  for (int l = 0; l < file.parts(); ++l) {
    const auto* value = file.header(l).findTypedAttribute<Imf::FloatAttribute>("standardError");
    if (value == nullptr) return {};
    errors.push_back(value->value());
  }
  return errors;
}

std::vector<float> read_view_values(const fs::path& path, int width, int height,
                                    std::size_t lights) {
  Imf::MultiPartInputFile file = open_view(path);
  if (file.parts() != static_cast<int>(lights)) {
    throw bad_input(path.string(),
                    fmt::format("has {} parts; expected {}, one a light", file.parts(), lights));
  }
  const std::size_t part_size = static_cast<std::size_t>(3) * width * height;
  std::vector<float> values(part_size * lights);
  for (std::size_t l = 0; l < lights; ++l) {
    const Imf::Header& header = file.header(static_cast<int>(l));
    const Imath::Box2i window = header.dataWindow();
    if (window.max.x - window.min.x + 1 != width || window.max.y - window.min.y + 1 != height) {
      throw bad_input(path.string(), fmt::format("part {} is {} x {}; expected {} x {} texels", l,
                                                 window.max.x - window.min.x + 1,
                                                 window.max.y - window.min.y + 1, width, height));
    }
    if (window.min != Imath::V2i(0, 0)) {
      throw bad_input(path.string(), fmt::format("part {} starts at ({}, {}); expected (0, 0)", l,
                                                 window.min.x, window.min.y));
    }
    for (const char* name : channel_names) {
      if (header.channels().findChannel(name) == nullptr) {
        throw bad_input(path.string(), fmt::format("part {} has no channel {}", l, name));
      }
    }
    try {
      Imf::InputPart part(file, static_cast<int>(l));
      part.setFrameBuffer(frame_buffer(values.data() + l * part_size, width));
      part.readPixels(window.min.y, window.max.y);
    } catch (const std::exception& error) {
      throw unreadable(path, error.what());
    }
  }
  return values;
}

}  // namespace weft
