// From linear float pictures on the GPU to pictures for a screen: exposure and sRGB, error colours,
// their legend.
#pragma once

#include "gl_preview/gl_object.h"
#include "gl_preview/render_target.h"

namespace weft {

class DisplayPass {
 public:
  DisplayPass();

  /// `picture` times 2^exposure, sRGB-encoded, into `target` of the same size.
  void show(unsigned picture, float exposure, const RenderTarget& target) const;

  /// Mean absolute difference of the channels, as colours: dark purple 0, yellow `full_scale`
  /// and more, the scale of `weft compare`'s maps.
  void show_error(unsigned reference, unsigned test, float full_scale,
                  const RenderTarget& target) const;

  /// The colours from 0 (left) to full scale (right).
  void show_legend(const RenderTarget& target) const;

 private:
  void draw(const GlLinkedProgram& program, const RenderTarget& target) const;

  GlVertexArray no_attributes_;
  GlLinkedProgram exposure_;
  GlLinkedProgram error_;
  GlLinkedProgram legend_;
};

}  // namespace weft
