// A headless context for a test, or a warning and none where this machine has no EGL.
#pragma once

#include <catch2/catch.hpp>
#include <memory>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

inline std::unique_ptr<weft::GlContext> gl_or_skip() {
  try {
    return std::make_unique<weft::GlContext>();
  } catch (const weft::Error& error) {
    WARN("skipped: " << error.what());
    return nullptr;
  }
}
